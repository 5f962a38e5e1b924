// SPDX-License-Identifier: Apache-2.0
#include "tools/can/recognition/recognised_bus.hpp"

#include "dfdyn/hal/replay_bus.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/can/check/bus_check.hpp"
#include "tools/can/families/family_catalogue.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace dfdyn::tools {

void TrafficRecorder::take(const hal::Frame& frame) noexcept {
    const bool early = frames_.empty() || seconds_of(frame.stamp_ns - frames_.front().stamp_ns) < longest_s;
    if (!frame.error && early && frames_.size() < most_frames) {
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

/// Returns each family that explains identifiers better than any other, best first.
std::vector<RecognisedFamily> recognise_families(std::span<const hal::Frame> frames) {
    std::vector<RecognisedFamily> all;
    for (const JointFamily& family : joint_families()) {
        if (family.recognise != nullptr) {
            Recognition recognition = family.recognise(frames);
            if (!recognition.boards.empty()) {
                all.push_back({family.name, std::move(recognition)});
            }
        }
    }
    std::ranges::stable_sort(all, std::ranges::greater(),
                             [](const RecognisedFamily& family) { return family.recognition.score; });
    std::vector<RecognisedFamily> chosen;
    for (RecognisedFamily& family : all) {
        if (std::ranges::none_of(chosen, [&](const RecognisedFamily& better) {
                return overlap(better.recognition, family.recognition);
            })) {
            chosen.push_back(std::move(family));
        }
    }
    return chosen;
}

/// Rounds a rate (Hz) to three significant digits.
double rounded_rate(double rate_hz) {
    const double step = std::pow(10, std::floor(std::log10(rate_hz)) - 2);
    return std::round(rate_hz / step) * step;
}

nlohmann::json draft_of(const RecognisedFamily& family) {
    const Recognition& recognition = family.recognition;
    nlohmann::json joints = recognition.fields;
    joints["family"] = family.name;
    int joint = 0;
    double rate_hz = recognition.boards.front().rate_hz;
    for (const RecognisedBoard& board : recognition.boards) {
        nlohmann::json entry = board.entry;
        if (board.joints == 1) {
            entry["joint"] = ++joint;
        } else {
            entry["joints"] = {joint + 1, joint + 2};
            joint += 2;
        }
        joints["boards"].push_back(entry);
        rate_hz = std::min(rate_hz, board.rate_hz);
    }
    return {{"schema", "dfdyn.bus/1"},
            {"bit_rate", 1'000'000},
            {"sample_rate_hz", rounded_rate(rate_hz)},
            {"trigger", {{"on", "timer"}}},
            {"joints", joints},
            {"output", {{"family", "efforts"}, {"quantity", recognition.quantity}}}};
}

/// Returns true for rules that require a description by a person: senders and their rates.
bool judges_description(const BusFinding& finding, const BusCheck& check) {
    const std::vector<BusFinding> source = source_findings(check);
    return finding.rule == "unknown_traffic" || finding.rule == "overload" ||
           std::ranges::any_of(source, [&](const BusFinding& other) { return other.rule == finding.rule; });
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
    for (BusFinding& finding : bus_findings(check)) {
        if (!judges_description(finding, check)) {
            result.findings.push_back(std::move(finding));
        }
    }
    for (const BusBoard& board : check.boards()) {
        if (std::string summary = board.board->host_summary(); !summary.empty()) {
            result.commands.push_back("joint " + std::to_string(board.joint[0] + 1) + ": " + summary);
        }
    }
}

} // namespace

RecognisedBus recognise_bus(std::span<const hal::Frame> frames) {
    RecognisedBus result;
    if (frames.empty()) {
        result.draft_error = "there are no frames";
        return result;
    }
    result.duration_s = seconds_of(frames.back().stamp_ns - frames.front().stamp_ns);
    result.families = recognise_families(frames);
    if (result.families.empty()) {
        result.draft_error = "no family of devices is recognised";
        return result;
    }
    for (const RecognisedFamily& known : result.families) {
        for (const unsigned motor : known.recognition.silent) {
            result.findings.push_back({"silent_motor",
                                       std::string(known.name) + " motor " + std::to_string(motor) +
                                           " is commanded and never answers",
                                       "commands to it, and no frame of it",
                                       "read its state with the maker's own program",
                                       "check the motor's power, cable and number; it is not a joint at 0"});
        }
    }
    const RecognisedFamily& family = result.families.front();
    if (family.recognition.quantity.empty()) {
        result.draft_error = "the boards send no efforts, and no sensor is recognised";
        return result;
    }
    nlohmann::json draft = draft_of(family);
    try {
        check_draft(parse_bus_description(draft, "the draft"), frames, result);
        result.draft = std::move(draft);
    } catch (const InputError& error) {
        result.draft_error = error.what();
    }
    return result;
}

nlohmann::ordered_json recognised_json(const RecognisedBus& bus) {
    nlohmann::ordered_json families = nlohmann::ordered_json::array();
    nlohmann::ordered_json recognised = nlohmann::ordered_json::array();
    for (const RecognisedFamily& family : bus.families) {
        families.push_back(family.name);
        nlohmann::ordered_json boards = nlohmann::ordered_json::array();
        for (const RecognisedBoard& board : family.recognition.boards) {
            boards.push_back(
                {{"name", board.name}, {"positions_hz", board.rate_hz}, {"measured", board.measured}});
        }
        recognised.push_back(
            {{"family", family.name}, {"boards", std::move(boards)}, {"unsure", family.recognition.unsure}});
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
    for (const RecognisedFamily& family : bus.families) {
        out << "  " << family.name << '\n';
        for (const RecognisedBoard& board : family.recognition.boards) {
            out << "    " << board.name << ": " << rounded_text(board.rate_hz) << " positions/s"
                << (board.measured.empty() ? "" : "; ") << board.measured << '\n';
        }
        for (const std::string& unsure : family.recognition.unsure) {
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
    if (!bus.draft) {
        out << "  no draft of a description: " << bus.draft_error << '\n';
    }
}

} // namespace dfdyn::tools
