// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/recording.hpp"

#include "tools/base/text/text.hpp"

#include <charconv>
#include <filesystem>
#include <system_error>

namespace dfdyn::tools {
namespace {

InputError bad_range(std::string_view text, const std::string& expected) {
    return InputError("--rows: expected " + expected + ", found " + in_quotes(text));
}

/// Returns nothing if `bound` is empty. `text` is the whole option, for the message.
std::optional<std::size_t> parse_bound(std::string_view bound, std::string_view text) {
    if (bound.empty()) {
        return std::nullopt;
    }
    std::size_t value = 0;
    const char* const end = bound.data() + bound.size();
    const auto [stop, fault] = std::from_chars(bound.data(), end, value);
    if (stop != end || fault != std::errc{}) {
        throw bad_range(text, "FIRST:LAST, whole numbers from 0 or nothing");
    }
    return value;
}

void append_count(std::string& out, std::size_t count, std::string_view reason) {
    if (count > 0) {
        out += (out.empty() ? ": " : ", ") + std::to_string(count) + " " + std::string(reason);
    }
}

} // namespace

OutputKind parse_output_kind(std::string_view text) {
    if (text == "tau") {
        return OutputKind::joint_torque;
    }
    if (text == "i") {
        return OutputKind::motor_current;
    }
    if (text == "wrench") {
        return OutputKind::wrench;
    }
    throw InputError("--outputs: expected tau, i or wrench, found " + in_quotes(text));
}

std::vector<std::string> output_names(OutputKind kind, std::size_t joint_count) {
    if (kind == OutputKind::wrench) {
        return {"fx", "fy", "fz", "mx", "my", "mz"};
    }
    return joint_names(kind == OutputKind::joint_torque ? "tau" : "i", joint_count);
}

std::vector<std::string> joint_names(std::string_view prefix, std::size_t count) {
    std::vector<std::string> names;
    names.reserve(count);
    for (std::size_t joint = 1; joint <= count; ++joint) {
        names.push_back(std::string(prefix) + std::to_string(joint));
    }
    return names;
}

RowRange parse_row_range(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) {
        throw bad_range(text, "FIRST:LAST");
    }
    const std::size_t second = std::min(text.find(':', colon + 1), text.size());
    RowRange range{.first = parse_bound(text.substr(0, colon), text).value_or(0),
                   .last = parse_bound(text.substr(colon + 1, second - colon - 1), text)};
    if (second < text.size()) {
        range.step = parse_bound(text.substr(second + 1), text).value_or(0);
        if (range.step == 0) {
            throw bad_range(text, "FIRST:LAST:STEP with a STEP from 1");
        }
    }
    if (range.last && *range.last <= range.first) {
        throw bad_range(text, "FIRST before LAST (which is not included)");
    }
    return range;
}

std::string describe(const SkippedRows& skipped) {
    std::string reasons;
    append_count(reasons, skipped.ragged, "ragged");
    append_count(reasons, skipped.not_a_number, "not a number");
    append_count(reasons, skipped.out_of_range, "out of range");
    append_count(reasons, skipped.time_not_increasing, "time not increasing");
    return std::to_string(skipped.total()) + (skipped.total() == 1 ? " row skipped" : " rows skipped") +
           reasons;
}

std::vector<std::string> file_names(std::span<const Recording> recordings) {
    std::vector<std::string> names;
    for (const Recording& recording : recordings) {
        names.push_back(std::filesystem::path(recording.source).filename().string());
    }
    return names;
}

} // namespace dfdyn::tools
