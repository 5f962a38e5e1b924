// SPDX-License-Identifier: Apache-2.0
#include "tools/can/recognition/recognised_bus.hpp"

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/replay_bus.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/can/families/family_catalogue.hpp"
#include "tools/can/recognition/bus_draft.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace dfdyn::tools {

void TrafficTime::take(std::int64_t stamp_ns) noexcept {
    constexpr std::int64_t longest_ns = 1'000'000'000;
    const std::int64_t step_ns = latest_ns_ ? hal::wrapping_difference(stamp_ns, *latest_ns_) : 0;
    sum_ns_ += step_ns > 0 && step_ns <= longest_ns ? step_ns : 0;
    if (!latest_ns_ || step_ns > 0 || step_ns < -longest_ns) {
        latest_ns_ = stamp_ns;
    }
}

void TrafficRecorder::take(const hal::Frame& frame) noexcept {
    if (frame.error || frames_.size() == most_frames || time_.seconds() >= longest_s) {
        return;
    }
    time_.take(frame.stamp_ns);
    if (time_.seconds() < longest_s) {
        frames_.push_back(frame);
    }
}

namespace {

/// Frames in memory, as a hal::ReplaySource.
class FrameTape {
  public:
    explicit FrameTape(std::span<const hal::Frame> frames) : frames_(frames) {}

    bool next(hal::ReplayEntry& entry) noexcept {
        entry = {};
        if (next_ == frames_.size()) {
            return false;
        }
        entry.frame = frames_[next_++];
        return true;
    }

  private:
    std::span<const hal::Frame> frames_;
    std::size_t next_ = 0;
};

bool overlap(const Recognition& a, const Recognition& b) {
    return std::ranges::any_of(a.identifiers,
                               [&](const BusStreamKey& key) { return b.identifiers.contains(key); });
}

/// Returns all families that can have sent some of the frames, best first.
std::vector<RecognisedFamily> possible_families(std::span<const hal::Frame> frames) {
    std::vector<RecognisedFamily> all;
    for (const JointFamily& family : joint_families()) {
        if (family.recognise != nullptr) {
            Recognition recognition = family.recognise(frames);
            if (!recognition.boards.empty()) {
                all.push_back({&family, std::move(recognition)});
            }
        }
    }
    std::ranges::stable_sort(all, std::ranges::greater(),
                             [](const RecognisedFamily& known) { return known.recognition.score; });
    return all;
}

/// Removes the silent motors whose commands are frames of the boards of other families.
void drop_explained_motors(std::vector<RecognisedFamily>& families) {
    for (RecognisedFamily& known : families) {
        const auto explained = [&](const BusStreamKey& command) {
            return std::ranges::any_of(families, [&](const RecognisedFamily& other) {
                return &other != &known && (other.recognition.identifiers.contains(command) ||
                                            other.recognition.reserved.contains(command));
            });
        };
        std::erase_if(known.recognition.silent, [&](const SilentMotor& motor) {
            return std::ranges::all_of(motor.commands, explained);
        });
    }
}

/// Returns each family that explains identifiers better than any other, best first.
std::vector<RecognisedFamily> recognise_families(std::span<const hal::Frame> frames) {
    constexpr double as_good = 0.98;
    std::vector<RecognisedFamily> chosen;
    for (RecognisedFamily& known : possible_families(frames)) {
        const auto better = std::ranges::find_if(chosen, [&](const RecognisedFamily& other) {
            return overlap(other.recognition, known.recognition);
        });
        if (better == chosen.end()) {
            chosen.push_back(std::move(known));
        } else if (known.recognition.score >= as_good * better->recognition.score) {
            better->recognition.unsure.push_back("the family: its frames may also be those of " +
                                                 std::string(known.family->name));
        }
    }
    drop_explained_motors(chosen);
    return chosen;
}

/// Returns true for rules that require a description by a person: senders and their rates.
/// `of_sources`: all findings about senders.
bool judges_description(const BusFinding& finding, std::span<const BusFinding> of_sources) {
    return finding.rule == "unknown_traffic" || finding.rule == "overload" ||
           std::ranges::any_of(of_sources,
                               [&](const BusFinding& other) { return other.rule == finding.rule; });
}

void check_draft(const BusDescription& description, std::span<const hal::Frame> frames,
                 RecognisedBus& result) {
    BusCheck check(description);
    FrameTape tape(frames);
    hal::ReplayBus bus(tape);
    std::array<hal::Frame, 1> room{};
    while (!bus.ended()) {
        bus.advance_to(bus.next_stamp_ns());
        check.take(bus, room);
    }
    check.finish();
    const std::vector<BusFinding> of_sources = source_findings(check);
    for (BusFinding& finding : bus_findings(check)) {
        if (!judges_description(finding, of_sources)) {
            result.findings.push_back(std::move(finding));
        }
    }
    for (const BusBoard& board : check.boards()) {
        if (std::string summary = board.board->host_summary(); !summary.empty()) {
            result.commands.push_back("joint " + std::to_string(board.joint[0] + 1) + ": " + summary);
        }
    }
}

void report_silent_motors(RecognisedBus& result) {
    for (const RecognisedFamily& known : result.families) {
        for (const SilentMotor& silent : known.recognition.silent) {
            result.findings.push_back({"silent_motor",
                                       std::string(known.family->name) + " motor " +
                                           std::to_string(silent.motor) + " is commanded and never answers",
                                       "commands to it, and no frame of it",
                                       "read its state with the maker's own program",
                                       "Check the motor's power, cable and number. It is not a joint at 0."});
        }
    }
}

/// Makes a draft of the first family with efforts, and checks it.
void make_draft(std::span<const hal::Frame> frames, RecognisedBus& result) {
    std::string without_efforts;
    for (RecognisedFamily& known : result.families) {
        if (known.recognition.quantity.empty()) {
            without_efforts += (without_efforts.empty() ? "" : "; ") + std::string(known.family->name) +
                               ": " + std::string(known.family->no_draft);
            continue;
        }
        try {
            nlohmann::json draft = draft_of(known, frames);
            check_draft(parse_bus_description(draft, "the draft"), frames, result);
            result.draft = std::move(draft);
            result.draft_error.clear();
            return;
        } catch (const InputError& error) {
            result.draft_error = error.what();
        }
    }
    if (result.draft_error.empty()) {
        result.draft_error = without_efforts;
    }
}

/// Returns the identifier `key` without the state of its sender. Requires that the family has identifiers
/// with a state.
BusStreamKey stateless_key(const JointFamily& family, const BusStreamKey& key) {
    hal::Frame frame = hal::make_frame(key.second, 8);
    frame.extended = key.first;
    return {key.first, family.stream_id(frame)};
}

/// The identifiers that differ only by the state of their sender.
struct SenderStates {
    int identifiers = 0;
    std::int64_t last_ns = std::numeric_limits<std::int64_t>::min(); ///< stamp of the last frame of all
};

/// Removes the findings about identifiers that end or pause because the state in them changed.
void drop_changes_of_state(const JointFamily& family, const BusStreams& streams,
                           std::vector<BusFinding>& findings) {
    std::map<BusStreamKey, SenderStates> senders;
    for (const auto& [key, stream] : streams) {
        SenderStates& states = senders[stateless_key(family, key)];
        ++states.identifiers;
        states.last_ns = std::max(states.last_ns, stream.last_ns);
    }
    for (const auto& [key, stream] : streams) {
        const SenderStates& states = senders.at(stateless_key(family, key));
        if (states.identifiers == 1) {
            continue;
        }
        const bool later = states.last_ns > stream.last_ns;
        const std::string subject = id_text(key) + " ";
        std::erase_if(findings, [&](const BusFinding& finding) {
            return finding.what.starts_with(subject) &&
                   ((later && finding.rule == "source_stopped") || finding.rule == "gaps" ||
                    finding.rule == "lost_frames");
        });
    }
}

} // namespace

RecognisedBus recognise_bus(std::span<const hal::Frame> frames) {
    RecognisedBus result;
    if (frames.empty()) {
        result.draft_error = "there are no frames";
        return result;
    }
    TrafficTime time;
    for (const hal::Frame& frame : frames) {
        time.take(frame.stamp_ns);
    }
    result.duration_s = time.seconds();
    result.families = recognise_families(frames);
    if (result.families.empty()) {
        result.draft_error =
            "no family of devices is recognised in " +
            (frames.size() < 2 ? "one frame"
                               : "the first " + rounded_text(result.duration_s) + " s of traffic");
        return result;
    }
    report_silent_motors(result);
    make_draft(frames, result);
    return result;
}

void add_findings(const RecognisedBus& bus, const BusCheck& check, std::vector<BusFinding>& findings) {
    for (const RecognisedFamily& known : bus.families) {
        if (known.family->stream_id != nullptr) {
            drop_changes_of_state(*known.family, check.streams(), findings);
        }
    }
    for (const BusFinding& finding : bus.findings) {
        if (std::ranges::none_of(findings, [&](const BusFinding& other) {
                return other.rule == finding.rule && other.what == finding.what;
            })) {
            findings.push_back(finding);
        }
    }
}

nlohmann::ordered_json recognised_json(const RecognisedBus& bus) {
    nlohmann::ordered_json families = nlohmann::ordered_json::array();
    nlohmann::ordered_json recognised = nlohmann::ordered_json::array();
    for (const RecognisedFamily& known : bus.families) {
        families.push_back(known.family->name);
        nlohmann::ordered_json boards = nlohmann::ordered_json::array();
        for (const RecognisedBoard& board : known.recognition.boards) {
            boards.push_back(
                {{"name", board.name}, {"positions_hz", board.rate_hz}, {"measured", board.measured}});
        }
        recognised.push_back({{"family", known.family->name},
                              {"boards", std::move(boards)},
                              {"unsure", known.recognition.unsure}});
    }
    nlohmann::ordered_json json{{"families", std::move(families)},
                                {"recognised_in_s", bus.duration_s},
                                {"recognised", std::move(recognised)},
                                {"commands", bus.commands},
                                {"draft_error", nullptr}};
    if (!bus.draft) {
        json["draft_error"] = bus.draft_error;
    }
    return json;
}

void print_recognised_bus(std::ostream& out, const RecognisedBus& bus) {
    out << "\nrecognised in " << rounded_text(bus.duration_s) << " s:\n";
    for (const RecognisedFamily& known : bus.families) {
        out << "  " << known.family->name << '\n';
        for (const RecognisedBoard& board : known.recognition.boards) {
            out << "    " << board.name << ": " << rounded_text(board.rate_hz) << " positions/s"
                << (board.measured.empty() ? "" : "; ") << board.measured << '\n';
        }
        for (const std::string& unsure : known.recognition.unsure) {
            out << "    unsure: " << unsure << '\n';
        }
        out << "    unsure: order, directions, zeros and encoders of the joints\n";
    }
    if (bus.families.empty()) {
        out << "  no family of devices\n";
    }
    for (const std::string& commands : bus.commands) {
        out << "  other programs command " << commands << '\n';
    }
    if (bus.draft && bus.families.size() > 1) {
        out << "  the draft has the joints of " << bus.draft->at("joints").at("family").get<std::string>()
            << " only\n";
    }
    if (!bus.draft) {
        out << "  no draft of a description: " << bus.draft_error << '\n';
    }
}

} // namespace dfdyn::tools
