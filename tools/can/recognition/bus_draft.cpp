// SPDX-License-Identifier: Apache-2.0
#include "tools/can/recognition/bus_draft.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/can/description/bus_description.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

/// Rounds a rate (Hz), which must be positive, to three significant digits.
double rounded_rate(double rate_hz) {
    const double step = std::pow(10, std::floor(std::log10(rate_hz)) - 2);
    return std::round(rate_hz / step) * step;
}

/// Returns the first boards that fit into a description. Adds the names of the others to `unsure`.
std::span<const RecognisedBoard> boards_of_draft(const std::vector<RecognisedBoard>& boards,
                                                 std::vector<std::string>& unsure) {
    int joints = 0;
    std::size_t count = 0;
    while (count < boards.size() && joints + boards[count].joints <= largest_bus_joint_count) {
        joints += boards[count++].joints;
    }
    std::vector<std::string> others;
    for (std::size_t i = count; i < boards.size(); ++i) {
        others.push_back(boards[i].name);
    }
    if (!others.empty()) {
        unsure.push_back("not in the draft, which has at most " + std::to_string(largest_bus_joint_count) +
                         " joints: " + listed(others));
    }
    return std::span(boards).first(count);
}

/// Sets the rates. If those of the boards differ, the fastest is the limit for a second sender on an
/// identifier, and the slowest determines how long values are valid. Throws InputError for a rate of 0.
void set_rates(std::span<const RecognisedBoard> boards, nlohmann::json& draft,
               std::vector<std::string>& unsure) {
    constexpr double same = 1.05;
    const auto [slowest, fastest] = std::ranges::minmax(boards, {}, &RecognisedBoard::rate_hz);
    if (slowest.rate_hz <= 0) {
        throw InputError("the time stamps of " + slowest.name +
                         " do not increase, so that its rate is unknown");
    }
    const double fastest_hz = rounded_rate(fastest.rate_hz);
    const double slowest_hz = rounded_rate(slowest.rate_hz);
    draft["sample_rate_hz"] = fastest_hz;
    if (fastest_hz <= same * slowest_hz) {
        return;
    }
    draft["sample_rate_hz"] = slowest_hz;
    draft["joints"]["rate_hz"] = fastest_hz;
    draft["trigger"]["delay_s"] = 1.5 / slowest_hz;
    for (const char* source : {"joints", "output"}) {
        draft[source]["max_age_s"] = 3 / slowest_hz;
    }
    unsure.push_back("sample_rate_hz: the boards send " + rounded_text(slowest_hz) + " to " +
                     rounded_text(fastest_hz) +
                     " positions/s; the draft has a sample for each of the slowest");
}

} // namespace

nlohmann::json draft_of(RecognisedFamily& known, std::span<const hal::Frame> frames) {
    Recognition& recognition = known.recognition;
    const std::span<const RecognisedBoard> boards = boards_of_draft(recognition.boards, recognition.unsure);
    nlohmann::json joints = recognition.fields;
    joints["family"] = known.family->name;
    int joint = 0;
    for (const RecognisedBoard& board : boards) {
        nlohmann::json entry = board.entry;
        if (board.joints == 1) {
            entry["joint"] = ++joint;
        } else {
            entry["joints"] = {joint + 1, joint + 2};
            joint += 2;
        }
        joints["boards"].push_back(entry);
    }
    nlohmann::json draft{{"schema", "dfdyn.bus/1"},
                         {"bit_rate", 1'000'000},
                         {"trigger", {{"on", "timer"}}},
                         {"joints", joints},
                         {"output", {{"family", "efforts"}, {"quantity", recognition.quantity}}}};
    set_rates(boards, draft, recognition.unsure);
    if (std::ranges::any_of(frames, [&](const hal::Frame& frame) {
            return frame.bit_rate_switch && recognition.identifiers.contains({frame.extended, frame.id});
        })) {
        draft["data_bit_rate"] = 5'000'000;
        recognition.unsure.emplace_back("data_bit_rate: 5 Mbit/s is assumed");
    }
    return draft;
}

} // namespace dfdyn::tools
