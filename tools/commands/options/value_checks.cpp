// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/value_checks.hpp"

#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <optional>
#include <utility>

namespace dfdyn::tools {
namespace {

std::string refused(const std::string& expected, const std::string& value) {
    return "expected " + expected + ", found " + in_quotes(value);
}

/// Accepts values for which `accepts` is true.
template <class Accepts>
CLI::Validator check_of(std::string expected, std::string description, Accepts accepts) {
    return {[expected = std::move(expected), accepts](const std::string& value) {
                return accepts(value) ? std::string() : refused(expected, value);
            },
            std::move(description)};
}

/// Accepts finite numbers for which `accepts` is true.
template <class Accepts>
CLI::Validator number_check(std::string expected, std::string description, Accepts accepts) {
    return check_of(std::move(expected), std::move(description), [accepts](const std::string& value) {
        const ParsedNumber number = parse_number(value);
        return number.fault == NumberFault::none && accepts(number.value);
    });
}

/// Returns the whole number that is all of `text`.
template <class Number>
std::optional<Number> whole_number(std::string_view text) {
    Number number = 0;
    const auto [rest, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool whole = fault == std::errc() && rest == text.data() + text.size();
    return whole ? std::optional(number) : std::nullopt;
}

/// Returns the bytes that a unit stands for; 0 if there is no such unit.
std::uint64_t unit_bytes(const std::string& unit) {
    constexpr std::array<std::pair<const char*, std::uint64_t>, 10> units{{{"", 1},
                                                                           {"b", 1},
                                                                           {"k", 1024},
                                                                           {"kb", 1024},
                                                                           {"kib", 1024},
                                                                           {"m", 1024 * 1024},
                                                                           {"mb", 1024 * 1024},
                                                                           {"mi", 1024 * 1024},
                                                                           {"mib", 1024 * 1024},
                                                                           {"ki", 1024}}};
    const auto found =
        std::ranges::find(units, CLI::detail::to_lower(unit), &std::pair<const char*, std::uint64_t>::first);
    return found == units.end() ? 0 : found->second;
}

std::optional<std::uint64_t> bytes_of(const std::string& text) {
    const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
    const auto count = whole_number<std::uint64_t>(std::string_view(text).substr(0, digits));
    const std::uint64_t unit = unit_bytes(CLI::detail::trim_copy(text.substr(digits)));
    const bool valid =
        count && *count > 0 && unit > 0 && *count <= std::numeric_limits<std::int64_t>::max() / unit;
    return valid ? std::optional(*count * unit) : std::nullopt;
}

} // namespace

CLI::Validator number_in(double least, double most) {
    const std::string from = number_text(least);
    const std::string to = number_text(most);
    return number_check("a number from " + from + " to " + to, "[" + from + " - " + to + "]",
                        [=](double value) { return value >= least && value <= most; });
}

CLI::Validator positive_number() {
    return number_check("a finite number above 0", "above 0", [](double value) { return value > 0; });
}

CLI::Validator number_from_zero() {
    return number_check("a finite number from 0", "from 0", [](double value) { return value >= 0; });
}

CLI::Validator finite_number() {
    return number_check("a finite number", "", [](double) { return true; });
}

CLI::Validator whole_number_in(std::int64_t least, std::int64_t most) {
    const bool open = most == std::numeric_limits<std::int64_t>::max();
    const std::string from = std::to_string(least);
    const std::string to = std::to_string(most);
    return check_of("a whole number from " + from + (open ? "" : " to " + to),
                    open ? "from " + from : "[" + from + " - " + to + "]", [=](const std::string& value) {
                        const auto number = whole_number<std::int64_t>(value);
                        return number && *number >= least && *number <= most;
                    });
}

CLI::Validator seed_number() {
    return check_of("a whole number from 0 to " + std::to_string(std::numeric_limits<std::uint64_t>::max()),
                    "from 0",
                    [](const std::string& value) { return whole_number<std::uint64_t>(value).has_value(); });
}

std::vector<std::string> words_of(const std::string& list) {
    std::vector<std::string> words = CLI::detail::split(list, ',');
    std::ranges::for_each(words, [](std::string& word) { CLI::detail::trim(word); });
    return words;
}

CLI::Validator one_of(std::vector<std::string> names) {
    std::string description = "{" + CLI::detail::join(names, ",") + "}";
    return {[names = std::move(names)](const std::string& value) {
                return std::ranges::find(names, value) != names.end()
                           ? std::string()
                           : refused("one of " + listed(names), value) + suggestion(value, names);
            },
            std::move(description)};
}

CLI::Validator byte_count() {
    return {[](std::string& value) {
                const std::optional<std::uint64_t> bytes = bytes_of(value);
                if (!bytes) {
                    return refused("a number of bytes above 0, such as 65536, 512K or 2M", value);
                }
                value = std::to_string(*bytes);
                return std::string();
            },
            ""};
}

} // namespace dfdyn::tools
