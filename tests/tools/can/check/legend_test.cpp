// SPDX-License-Identifier: Apache-2.0
// Each fault of the legend (docs/reference/faults.md), alone in the frames of each family: buscheck reports
// it by the findings that the legend names, and by no other.
#include "tests/hal/campaign/fault_actions.hpp"
#include "tests/tools/can/bus_check_support.hpp"
#include "tests/tools/can/example_arms.hpp"
#include "tests/tools/support/name_literals.hpp"
#include "tools/can/arm/device_frames.hpp"
#include "tools/can/families/family.hpp"

#include <map>
#include <tuple>

namespace bus_check_legend_test {

using namespace dfdyn::tests;
using dfdyn::tools::DeviceFrames;
namespace hal = dfdyn::hal;

/// Findings of a row of the legend: at least one of them must be reported, and no other.
using Expected = std::vector<std::string>;

/// Column `buscheck` of the legend by the fault's number.
std::map<int, Expected> legend() {
    std::map<int, Expected> rows;
    std::istringstream text(dfdyn::tools::read_file(project / "docs/reference/faults.md"));
    for (std::string line; std::getline(text, line) && line != "## Tested one by one";) {
        std::vector<std::string> cells;
        std::istringstream parts(line);
        for (std::string cell; std::getline(parts, cell, '|');) {
            cells.push_back(cell);
        }
        if (cells.size() < 9 || cells[1].find_first_of("0123456789") == std::string::npos) {
            continue;
        }
        Expected& names = rows[std::stoi(cells[1])];
        std::istringstream quoted(cells[6]);
        for (std::string word; std::getline(quoted, word, '`') && std::getline(quoted, word, '`');) {
            names.push_back(word);
        }
    }
    return rows;
}

wire::Frames frames_of(const hal::FrameList& list) {
    return {list.frame, static_cast<std::size_t>(list.count)};
}

hal::Wrench wrench_of(const BusDescription& description, const wire::SixWords& raw) {
    hal::Wrench wrench{};
    for (std::size_t k = 0; k < wrench.size(); ++k) {
        wrench[k] = description.output_range[k].highest * static_cast<double>(raw[k]) / 32768;
    }
    return wrench;
}

/// Adds what the boards send.
void add_boards(const BusDescription& description, CampaignArm& arm) {
    arm.boards = description.boards.size();
    arm.frames = [boards = description.boards](std::size_t board, const wire::Joints& joints) {
        std::array<hal::JointValue, 2> values{};
        for (std::size_t i = 0; i < 2; ++i) {
            if (const int joint = boards[board].joint[i]; joint != hal::unused_joint) {
                values[i].position_rad = joints[static_cast<std::size_t>(joint)].position_rad;
                values[i].velocity = joints[static_cast<std::size_t>(joint)].velocity;
                values[i].effort = joints[static_cast<std::size_t>(joint)].effort;
            }
        }
        return frames_of(boards[board].board.encode(values));
    };
    for (std::size_t board = 0; board < arm.boards; ++board) {
        dfdyn::tools::BusBoard decoder = description.boards[board];
        const wire::Frames frames = arm.frames(board, {});
        for (std::size_t part = 0; part < frames.count; ++part) {
            const hal::Decoded decoded = decoder.board.decode(frames.frame[part]);
            for (int i = 0; i < decoded.joints; ++i) {
                const hal::JointValue& value = decoded.joint[static_cast<std::size_t>(i)];
                if (value.position_reason != hal::Reason::waiting_for_position) {
                    arm.step_rad[static_cast<std::size_t>(value.joint)] = value.step_rad;
                    arm.zero_rad[static_cast<std::size_t>(value.joint)] =
                        value.position_rad - value.from_zero_rad;
                }
            }
        }
    }
    arm.find_fields();
}

/// A described arm in the form that the campaign's faults change.
CampaignArm campaign_arm(const BusDescription& description) {
    CampaignArm arm;
    arm.name = description.joint_family->name;
    arm.synchronous = description.synchronous;
    add_boards(description, arm);
    const DeviceFrames devices(description);
    arm.status = devices.heartbeats();
    if (description.sensor) {
        arm.output_range = description.output_range.front().highest;
        arm.wrench = [description](const wire::SixWords& raw) {
            return frames_of(description.sensor->encode(wrench_of(description, raw)));
        };
        arm.saturate_wrench = [description](Frame& frame, std::size_t half) {
            hal::Wrench beyond{};
            beyond.fill(1e6);
            frame.data = description.sensor->encode(beyond).frame.at(half).data;
        };
    }
    return arm;
}

/// The log of an arm that first reports the full scales of its sensor.
Frames recorded(const BusDescription& description, const Traffic& traffic) {
    Frames frames = DeviceFrames(description).full_scales();
    std::int64_t stamp_ns = traffic.front().frame.stamp_ns - 10'000'000;
    for (Frame& frame : frames) {
        frame.stamp_ns = stamp_ns += 200'000;
    }
    std::ranges::transform(traffic, std::back_inserter(frames), &Sent::frame);
    return frames;
}

bool same(const Frames& one, const Frames& other) {
    return std::ranges::equal(one, other, [](const Frame& a, const Frame& b) {
        return a.stamp_ns == b.stamp_ns && a.id == b.id && a.length == b.length && a.data == b.data &&
               a.extended == b.extended && a.fd == b.fd && a.remote == b.remote;
    });
}

/// An arm in motion, and its log.
struct Run {
    std::mt19937_64 engine{seed()};
    BusDescription description;
    CampaignArm arm;
    Scene scene;
    Traffic good;

    explicit Run(const BusDescription& described)
        : description(described),
          arm(campaign_arm(described)), scene{Truth(engine), 100'000'000'000, &engine},
          good(arm.run(scene, 2000)) {}

    /// Returns the frames with a detectable fault; empty if these devices cannot have it.
    Frames with(const Fault& fault) {
        constexpr int most_draws = 60;
        for (int i = 0; i < most_draws; ++i) {
            Traffic traffic = good;
            const std::int64_t begin_ns = scene.cycle_ns(std::uniform_int_distribution(300, 1200)(engine));
            FaultSite site{arm,    traffic,    begin_ns, begin_ns + nanoseconds(length_s(fault)),
                           engine, scene.truth};
            fault.apply(site);
            const Frames frames = recorded(description, traffic);
            if (!same(frames, recorded(description, good)) && shows(fault, site)) {
                return frames;
            }
        }
        return {};
    }

  private:
    static std::int64_t nanoseconds(double time_s) { return std::llround(1e9 * time_s); }

    /// Returns true if an effort that is frozen for 0.5 s is reported.
    static double length_s(const Fault& fault) {
        return fault.apply == freeze_effort ? 1.2 : fault.longest_s;
    }

    /// Returns false for a draw that differs too little from good frames. Examples: a fault that waited for
    /// motion until less than 60 % of it was left; no stamp error beyond that of overtaken frames; a clock
    /// step of almost whole periods; no position error beyond twice the motion in a period.
    bool shows(const Fault& fault, const FaultSite& site) const {
        constexpr std::array of_positions{corrupt_bits, zero_positions, restart_incremental, stick_bit};
        if (fault.apply == stamp_ahead || fault.apply == stamp_behind) {
            return std::ranges::any_of(site.traffic, [](const Sent& sent) {
                return std::abs(sent.frame.stamp_ns - sent.true_ns) > 5'000'000;
            });
        }
        if (fault.apply == clock_slightly) {
            return changes_phase(site.traffic.back().clock_ns);
        }
        if (std::ranges::find(of_positions, fault.apply) != of_positions.end()) {
            const double in_a_period_rad =
                description.joint_limits.front().velocity / description.joints.rate_hz;
            return largest_change_rad(site.traffic) > 2 * in_a_period_rad;
        }
        return site.end_ns - site.begin_ns >= nanoseconds(0.6 * length_s(fault));
    }

    /// Returns true if a clock step differs by at least a quarter of a period from whole periods, for each
    /// source.
    bool changes_phase(std::int64_t step_ns) const {
        const auto changes = [&](double rate_hz) {
            const double periods = 1e-9 * static_cast<double>(step_ns) * rate_hz;
            return std::abs(periods - std::round(periods)) >= 0.25;
        };
        return changes(description.joints.rate_hz) &&
               (!description.sensor || changes(description.output.rate_hz));
    }

    /// Returns the largest distance of a position from that of the same frame without the fault.
    double largest_change_rad(const Traffic& traffic) const {
        std::vector<dfdyn::tools::BusBoard> boards = description.boards;
        const auto key = [](const Sent& sent) { return std::tuple(sent.unit, sent.part, sent.cycle); };
        std::map<std::tuple<std::size_t, std::size_t, int>, const Sent*> before;
        for (const Sent& sent : good) {
            if (sent.role == Sent::Role::joints) {
                before[key(sent)] = &sent;
            }
        }
        double largest = 0;
        for (const Sent& sent : traffic) {
            const auto found = before.find(key(sent));
            if (sent.role == Sent::Role::joints && found != before.end() &&
                sent.frame.data != found->second->frame.data) {
                largest = std::max(largest, change_rad(boards, found->second->frame, sent.frame));
            }
        }
        return largest;
    }

    /// Returns the largest distance between the positions of two frames, for positions in both.
    static double change_rad(std::vector<dfdyn::tools::BusBoard>& boards, const hal::Frame& good,
                             const hal::Frame& faulty) {
        const auto known = [](const auto& joint) {
            return joint.position_reason != hal::Reason::waiting_for_position;
        };
        double largest = 0;
        for (dfdyn::tools::BusBoard& board : boards) {
            const hal::Decoded one = board.board.decode(good);
            const hal::Decoded other = board.board.decode(faulty);
            for (std::size_t k = 0; k < static_cast<std::size_t>(std::min(one.joints, other.joints)); ++k) {
                if (known(one.joint[k]) && known(other.joint[k])) {
                    largest =
                        std::max(largest, std::abs(other.joint[k].position_rad - one.joint[k].position_rad));
                }
            }
        }
        return largest;
    }
};

/// Returns true if the devices report an effort at the end of its range.
bool reports_saturation(const BusDescription& description) {
    dfdyn::tools::BusBoard board = description.boards.front();
    std::array<hal::JointValue, 2> beyond{};
    beyond[0].effort = beyond[1].effort = 1e6;
    const hal::FrameList frames = board.board.encode(beyond);
    bool reports = false;
    for (int i = 0; i < frames.count; ++i) {
        const hal::Decoded decoded = board.board.decode(frames.frame[static_cast<std::size_t>(i)]);
        reports = reports || decoded.joint[0].effort_reason == hal::Reason::output_saturated;
    }
    return reports;
}

/// Returns false for faults of efforts if the sensor measures the outputs, and for faults of single frames if
/// several messages share each identifier.
bool matters(const BusDescription& description, const Fault& fault) {
    const bool of_effort = fault.apply == freeze_effort || fault.apply == saturate_effort;
    const bool of_frames = fault.apply == delay_frames || fault.apply == duplicate_frames ||
                           fault.apply == swap_frames || fault.apply == clock_slightly;
    const BusCheck check(description);
    std::set<std::string> senders; ///< with an identifier for one message
    for (const auto& [key, stream] : check.streams()) {
        if (!stream.several && stream.expected_hz > 0) {
            senders.insert(stream.sender);
        }
    }
    if ((fault.apply == clock_slightly && senders.size() < 2) ||
        (fault.apply == saturate_effort && !reports_saturation(description))) {
        return false;
    }
    const bool shared = std::ranges::all_of(check.streams(), [](const auto& stream) {
        return stream.second.several || stream.second.expected_hz == 0;
    });
    return !(of_effort && description.sensor) && !(of_frames && shared);
}

/// Draws of a fault, and how many of them are reported by the legend's findings and no other.
struct Drawn {
    int draws = 0, right = 0;

    double share() const { return draws > 0 ? static_cast<double>(right) / draws : 0; }
};

constexpr double least_share = 0.9; ///< right draws of a fault over all families

Drawn draw(Run& run, const Fault& fault, const Expected& names) {
    constexpr int draws = 3;
    Drawn drawn;
    for (int i = 0; i < draws; ++i) {
        const Frames frames = run.with(fault);
        if (frames.empty()) {
            break;
        }
        const Names found = rules(run.description, frames);
        ++drawn.draws;
        drawn.right += !found.empty() && std::ranges::all_of(found, [&](const std::string& name) {
            return std::ranges::find(names, name) != names.end();
        });
    }
    return drawn;
}

void check_legend(const std::vector<BusDescription>& arms) {
    const std::map<int, Expected> expected = legend();
    std::map<int, Drawn> sums;
    std::size_t pairs = 0;
    for (const BusDescription& description : arms) {
        Run run(description);
        CAPTURE(run.arm.name, description.sensor.has_value());
        CHECK(rules(description, recorded(description, run.good)) == Names{});
        for (const Fault& fault : campaign_faults()) {
            const Drawn drawn =
                matters(description, fault) ? draw(run, fault, expected.at(fault.number)) : Drawn{};
            CAPTURE(fault.number, fault.name);
            CHECK((drawn.right > 0 || drawn.draws == 0)); // without draws, these devices cannot have it
            pairs += drawn.draws > 0 ? 1 : 0;
            sums[fault.number].draws += drawn.draws;
            sums[fault.number].right += drawn.right;
        }
    }
    for (const Fault& fault : campaign_faults()) {
        const Drawn& sum = sums[fault.number];
        CAPTURE(fault.number, fault.name, sum.right, sum.draws);
        CHECK(sum.share() >= least_share);
    }
    CHECK(pairs >= 24 * arms.size()); // of 32: efforts or a sensor, and a SYNC or none
}

TEST_CASE("buscheck reports each fault of the legend by the legend's findings in each family") {
    check_legend(example_arms(true));
}

TEST_CASE("buscheck reports each fault of the legend by the legend's findings with each sensor", "[.long]") {
    check_legend(example_arms());
}

} // namespace bus_check_legend_test
