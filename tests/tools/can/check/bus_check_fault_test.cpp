// SPDX-License-Identifier: Apache-2.0
// Faults that resemble others: each is reported by its own rule with its rate, and by no other.
#include "dfdyn/hal/device/icub_strain.hpp"

#include "tests/tools/can/bus_check_support.hpp"

namespace {

using namespace dfdyn::tests;
using Catch::Matchers::ContainsSubstring;
using dfdyn::hal::make_frame;
using dfdyn::tools::read_bus_description;

BusDescription foc_boards() { return read_bus_description(bus_folder + "ur5_icub_2foc.json"); }

std::vector<BusDescription> every_family() {
    std::vector<BusDescription> descriptions;
    for (const char* const name : {"icub_arm_strain", "ur5_cia402", "ur5_cia402_torque", "ur5_icub_2foc",
                                   "ur5_two_joint_boards", "ur5_dbc"}) {
        descriptions.push_back(read_bus_description(bus_folder + name + ".json"));
    }
    descriptions.push_back(described(odrive_and_ati));
    descriptions.push_back(described(foc_and_robotous));
    return descriptions;
}

/// Identifier of joint 1's positions.
std::uint32_t first_id(const BusDescription& description) {
    return description.boards.front().board.encode({}).frame[0].id;
}

std::string evidence_of(const BusCheck& check, const std::string& rule) {
    for (const dfdyn::tools::BusFinding& finding : bus_findings(check)) {
        if (finding.rule == rule) {
            return finding.what + ": " + finding.evidence;
        }
    }
    return "";
}

/// Applies `change` to the frames of one identifier from `from_s` to `to_s`.
Frames changed_between(const Frames& frames, std::uint32_t id, double from_s, double to_s,
                       const std::function<void(Frame&)>& change) {
    return changed(frames, [&](Frame& frame) {
        const double time_s = 1e-9 * static_cast<double>(frame.stamp_ns);
        if (frame.id == id && time_s >= from_s && time_s < to_s) {
            change(frame);
        }
    });
}

} // namespace

TEST_CASE("the loss of one in a hundred frames of a joint is found with its rate in every family") {
    for (const BusDescription& description : every_family()) {
        DFDYN_SEEDED_ENGINE(engine);
        CAPTURE(description.source);
        std::bernoulli_distribution lost(0.01);
        int count = 0;
        const Frames frames = without(sound(description, 20), [&](const Frame& frame) {
            const bool gone = frame.id == first_id(description) && lost(engine);
            count += gone ? 1 : 0;
            return gone;
        });
        const BusCheck check = checked(description, frames);
        CHECK(rules_of(check) == Names{"lost_frames"});
        CHECK_THAT(evidence_of(check, "lost_frames"),
                   ContainsSubstring(": " + std::to_string(count) + " of "));
    }
}

TEST_CASE("a clock step is reported and no source is reported as slow or silent or stopped") {
    for (const BusDescription& description : {icub(), drives(), described(odrive_and_ati)}) {
        const Frames good = sound(description);
        for (const double step_s : {3600.0, 2.0, -2.0, -3600.0}) {
            Frames frames = good;
            for (std::size_t i = frames.size() / 2; i < frames.size(); ++i) {
                frames[i].stamp_ns += std::llround(1e9 * step_s);
            }
            CAPTURE(description.source, step_s);
            CHECK(rules(description, frames) == Names{"clock_jumped"});
            CHECK(rules(std::nullopt, frames) == Names{"clock_jumped"});
        }
    }
}

TEST_CASE("a single wrong time stamp is reported and no source is reported as slow or silent or stopped") {
    for (const std::int64_t off_s : {100'000, 10, -10}) {
        Frames frames = sound(icub());
        frames[frames.size() / 2].stamp_ns += off_s * 1'000'000'000;
        CAPTURE(off_s);
        CHECK(rules(icub(), frames) == Names{"clock_jumped"});
        frames.back().stamp_ns += off_s * 1'000'000'000;
        CHECK(rules(icub(), frames) == Names{"clock_jumped"});
    }
}

TEST_CASE("an effort at the end of its range is found with its share") {
    const auto ends = [](std::size_t low) {
        return [low](Frame& frame) { frame.data[low] = 0xFF, frame.data[low + 1] = 0x7F; };
    };
    const BusCheck drive = checked(drives(), changed_between(sound(drives()), 0x281, 1, 2, ends(4)));
    CHECK(rules_of(drive) == Names{"effort_saturated"});
    CHECK_THAT(evidence_of(drive, "effort_saturated"),
               ContainsSubstring("joint 1") && ContainsSubstring("25"));
    const BusCheck board = checked(foc_boards(), changed_between(sound(foc_boards()), 0x110, 1, 2, ends(0)));
    CHECK(rules_of(board) == Names{"effort_saturated"});
}

TEST_CASE("a constant effort of a moving joint is found") {
    const auto frozen = [](std::size_t low) {
        return [low](Frame& frame) { frame.data[low] = 0x12, frame.data[low + 1] = 0x03; };
    };
    CHECK(rules(drives(), changed_between(sound(drives(), 6), 0x281, 1, 4, frozen(4))) ==
          Names{"effort_frozen"});
    CHECK(rules(foc_boards(), changed_between(sound(foc_boards(), 6), 0x110, 1, 4, frozen(0))) ==
          Names{"effort_frozen"});
}

TEST_CASE("an encoder that freezes in motion is reported, with or without a recovery") {
    for (const double to_s : {3.0, 100.0}) {
        std::optional<Frame> last;
        const auto freeze = [&](Frame& frame) {
            last = last.value_or(frame);
            std::copy_n(last->data.begin(), 4, frame.data.begin());
        };
        CAPTURE(to_s);
        // joint 1 moves fastest around t = 0
        CHECK(rules(drives(), changed_between(sound(drives()), 0x281, 0.2, to_s, freeze)) ==
              Names{"encoder_frozen"});
    }
}

TEST_CASE("a joint at rest and one that decelerates normally give no finding") {
    const BusDescription bus = drives();
    Frames frames;
    dfdyn::tools::BusTraffic traffic(bus, {20, 1}, [&](const Frame& frame) { frames.push_back(frame); });
    DFDYN_SEEDED_ENGINE(engine);
    std::normal_distribution<double> noise;
    for (int row = 0; row < 1000; ++row) {
        const double t = 0.008 * row;
        const double moving = std::min(t, 3.0); // brakes with 2 rad/s^2 from 1 rad/s
        const double q = t < 2.5 ? 0.4 * t : 1 + 0.4 * (moving - 2.5) - 0.4 * (moving - 2.5) * (moving - 2.5);
        std::vector<double> effort(6);
        std::ranges::generate(effort, [&] { return noise(engine); });
        traffic.add(std::llround(1e9 * t), std::vector<double>(6, q), effort);
    }
    traffic.finish();
    CHECK(rules(bus, frames) == Names{});
}

/// Two drives with positions of 16 bits, which wrap after a turn, and efforts on the PDO `effort`.
BusDescription drives_of_16_bits(const std::string& effort) {
    return described(R"({"schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 125,
        "trigger": {"on": "sync"}, "joints": {"family": "cia402",
            "position": {"pdo": "0x280", "length": 2, "start_bit": 0, "bits": 16},
            "effort": {"pdo": ")" +
                     effort + R"(", "length": 2, "start_bit": 0, "bits": 16}, "boards": [
                {"node": 1, "joint": 1, "counts_per_turn": 65536, "effort_per_count": 0.01},
                {"node": 2, "joint": 2, "counts_per_turn": 65536, "effort_per_count": 0.01}]},
        "output": {"family": "efforts", "quantity": "tau"}})");
}

TEST_CASE("an arm at rest with constant efforts gives no finding, and a flipped bit only its own") {
    const BusDescription bus = drives_of_16_bits("0x180"); // sent before the positions
    Frames frames;
    dfdyn::tools::BusTraffic traffic(bus, {20, 1}, [&](const Frame& frame) { frames.push_back(frame); });
    for (int row = 0; row < 500; ++row) {
        traffic.add(row * std::int64_t{8'000'000}, std::vector<double>{1.2, 0.9}, std::vector<double>{2, 1});
    }
    traffic.finish();
    CHECK(rules(bus, frames) == Names{});
    const auto middle = std::ranges::find_if(
        frames, [](const Frame& frame) { return frame.id == 0x281 && frame.stamp_ns > 2'000'000'000; });
    REQUIRE(middle != frames.end());
    for (const int bit : {0x08, 0x10}) {
        CAPTURE(bit);
        Frame& frame = *middle;
        frame.data[1] = static_cast<std::uint8_t>(frame.data[1] ^ bit);
        CHECK(rules(bus, frames) == Names{"bits_flipped"});
        frame.data[1] = static_cast<std::uint8_t>(frame.data[1] ^ bit);
    }
}

TEST_CASE("a joint that passes the wrap of its drive's integer gives no finding") {
    const BusDescription bus = drives_of_16_bits("0x380");
    CHECK(rules(bus, changed(sound(bus, 8), [](Frame& frame) {
                    if (frame.id == 0x281) { // around half a turn
                        const auto counts = dfdyn::hal::load_little<std::uint16_t>(frame.data.data());
                        dfdyn::hal::store_little(frame.data.data(),
                                                 static_cast<std::uint16_t>(counts + 28'600));
                    }
                })) == Names{});
}

TEST_CASE("two senders of a joint's identifier are found and their positions give no finding") {
    for (const BusDescription& description : every_family()) {
        CAPTURE(description.source);
        Frames frames = sound(description);
        const std::uint32_t id = first_id(description);
        const std::size_t count = frames.size();
        const auto delay_ns = std::llround(0.43e9 / description.joints.rate_hz);
        for (std::size_t i = 0; i < count; ++i) {
            if (frames[i].id == id) {
                frames.push_back(frames[i]);
                frames.back().stamp_ns += delay_ns;
                frames.back().data[0] ^= 0x15;
            }
        }
        CHECK(rules(description, changed(frames, [](Frame&) {})) == Names{"id_collision"});
    }
}

TEST_CASE("an encoder that wraps after a turn and a single wrong position are reported") {
    const auto moved_by = [](std::int32_t counts) {
        return [counts](Frame& frame) {
            const auto now = dfdyn::hal::load_little<std::int32_t>(frame.data.data());
            dfdyn::hal::store_little(frame.data.data(), now + counts);
        };
    };
    const Frames good = sound(drives());
    CHECK(rules(drives(), changed_between(good, 0x281, 2, 100, moved_by(-1'048'576))) ==
          Names{"position_wrap"});
    CHECK(rules(drives(), changed_between(good, 0x281, 2, 100, moved_by(300'000))) == Names{"position_jump"});
    CHECK(rules(drives(), changed_between(good, 0x281, 2, 2.1, [](Frame& frame) {
                    std::fill_n(frame.data.begin(), 4, std::uint8_t{0});
                })) == Names{"position_zeros"});
}

TEST_CASE("a drive that restarts while it sends is reported and one that boots before is not") {
    const Frames good = sound(drives());
    CHECK(rules(drives(), with(good, make_frame(0x701, 1))) == Names{"device_restarted"});
    Frames early = good;
    for (std::uint32_t node = 1; node <= 6; ++node) {
        Frame boot_up = make_frame(0x700 + node, 1);
        boot_up.stamp_ns = good.front().stamp_ns - 1'000'000;
        early.insert(early.begin(), boot_up);
    }
    CHECK(rules(drives(), early) == Names{});
}

TEST_CASE("an ODrive with firmware 0.6 that has finished its trajectories gives no finding") {
    const BusDescription arm = described(odrive_and_ati);
    CHECK(rules(arm, changed(sound(arm), [](Frame& frame) {
                    frame.data[6] = (frame.id & 0x1F) == 0x01 ? 1 : frame.data[6];
                })) == Names{});
    CHECK(rules(arm, changed(sound(arm), [](Frame& frame) {
                    frame.data[0] = frame.id == 0x021 ? 8 : frame.data[0];
                })) == Names{"encoder_fault"});
}

TEST_CASE("a full scale of another set is distinguished from one that contradicts the description") {
    const dfdyn::hal::icub::StrainBoard board(13);
    const auto rules_with = [&](int set) {
        return rules(icub(), with(sound(icub()), board.encode_full_scale(0, 500, set)));
    };
    CHECK(rules_with(2) == Names{"full_scale_other_set"});
    CHECK(rules_with(0) == Names{"full_scale_contradicted"});
    CHECK(rules(icub(), with(sound(icub()), board.encode_full_scale(0, 1500, 2))) == Names{});
}

TEST_CASE("without a description a valid bus of any family gives no finding") {
    for (const BusDescription& description : every_family()) {
        CAPTURE(description.source);
        CHECK(rules(std::nullopt, sound(description)) == Names{});
    }
}

TEST_CASE("without a description losses and gaps and silence and error frames are found") {
    const Frames good = sound(icub());
    int count = 0;
    CHECK(rules(std::nullopt, without(good, [&](const Frame& frame) {
                    return frame.id == 0x111 && ++count % 50 == 0;
                })) == Names{"lost_frames"});
    CHECK(rules(std::nullopt, without(good, [](const Frame& frame) {
                    return frame.id == 0x111 && frame.stamp_ns / 20'000'000 == 100;
                })) == Names{"gaps"});
    CHECK(rules(std::nullopt, without(good, [](const Frame& frame) {
                    return frame.id == 0x111 && frame.stamp_ns > 3'000'000'000;
                })) == Names{"source_stopped"});
    CHECK(rules(std::nullopt, with(good, error_frame(dfdyn::hal::error_class::bus_off))) == Names{"bus_off"});
    CHECK(rules(std::nullopt, with(good, error_frame(dfdyn::hal::error_class::protocol))) ==
          Names{"wire_errors"});
    CHECK(rules(std::nullopt, {}) == Names{"silent_bus"});
    std::ostringstream out;
    print_bus_check(out, checked(std::nullopt, good), {});
    CHECK_THAT(out.str(), ContainsSubstring("0x111 ") && ContainsSubstring("the load is not known"));
}
