// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/units.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <system_error>

namespace dfdyn::tools {
namespace {

constexpr double turn = 2 * std::numbers::pi;

/// Factors of the units, by quantity. Positions also have the unit `ticks:N`.
const std::map<std::string, std::map<std::string, double>>& known_units() {
    static const std::map<std::string, double> position{{"rad", 1},     {"mrad", 1e-3}, {"deg", turn / 360},
                                                        {"turn", turn}, {"m", 1},       {"mm", 1e-3}};
    static const std::map<std::string, std::map<std::string, double>> table{
        {"t", {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}}},
        {"q", position},
        {"qd", position},
        {"qdd", position},
        {"tau", {{"Nm", 1}, {"mNm", 1e-3}}},
        {"i", {{"A", 1}, {"mA", 1e-3}}},
        {"wrench", {{"N", 1}, {"mN", 1e-3}}},
    };
    return table;
}

double factor_of(const std::string& quantity, const std::string& unit) {
    const std::map<std::string, double>& known = known_units().at(quantity);
    constexpr std::string_view ticks = "ticks:";
    const bool position = known.contains("rad");
    if (position && unit.starts_with(ticks)) {
        const ParsedNumber count = parse_number(std::string_view(unit).substr(ticks.size()));
        if (count.fault == NumberFault::none && count.value != 0) {
            return turn / count.value;
        }
    }
    if (const auto found = known.find(unit); found != known.end()) {
        return found->second;
    }
    std::vector<std::string> names;
    for (const auto& [name, factor] : known) {
        names.push_back(name);
    }
    if (position) {
        names.emplace_back("ticks:N (N per turn, not 0)");
    }
    throw InputError("--units " + quantity + ": expected one of " + listed(names) + ", found " +
                     in_quotes(unit) + suggestion(unit, names));
}

std::vector<std::string> split(std::string_view text, char separator) {
    std::vector<std::string> parts;
    std::size_t begin = 0;
    while (begin <= text.size()) {
        const std::size_t end = std::min(text.find(separator, begin), text.size());
        parts.emplace_back(trimmed(text.substr(begin, end - begin)));
        begin = end + 1;
    }
    return parts;
}

} // namespace

Units parse_units(std::string_view text) {
    Units units;
    if (text.empty()) {
        return units;
    }
    for (const std::string& entry : split(text, ',')) {
        const std::size_t equals = entry.find('=');
        const std::string quantity = entry.substr(0, equals);
        if (equals == std::string::npos || !known_units().contains(quantity)) {
            throw InputError(
                "--units: expected QUANTITY=UNIT with a quantity t, q, qd, qdd, tau, i or wrench, "
                "found " +
                in_quotes(entry));
        }
        for (const std::string& unit : split(std::string_view(entry).substr(equals + 1), '|')) {
            units[quantity].push_back({unit, factor_of(quantity, unit)});
        }
    }
    for (const char* const derivative : {"qd", "qdd"}) {
        if (units.contains("q") && !units.contains(derivative)) {
            units[derivative] = units["q"];
        }
    }
    return units;
}

double unit_factor(const Units& units, const std::string& quantity, std::size_t index, std::size_t count) {
    const auto found = units.find(quantity);
    if (found == units.end()) {
        return 1;
    }
    const std::vector<ColumnUnit>& columns = found->second;
    if (columns.size() != 1 && columns.size() != count) {
        throw InputError("--units " + quantity + ": expected one unit or " + std::to_string(count) +
                         ", one per column, found " + std::to_string(columns.size()));
    }
    return columns[columns.size() == 1 ? 0 : index].factor;
}

void check_units(const Units& units, const std::vector<bool>& prismatic) {
    const auto sliding = static_cast<std::size_t>(std::ranges::count(prismatic, true));
    const bool mixed = sliding > 0 && sliding < prismatic.size();
    for (const auto& [quantity, columns] : units) {
        if (!known_units().at(quantity).contains("rad")) {
            continue;
        }
        if (mixed && columns.size() == 1 && columns.front().factor != 1) {
            throw InputError("--units " + quantity +
                             ": expected one unit per joint, separated by |, because some joints are "
                             "prismatic and others turn, found one unit");
        }
        for (std::size_t joint = 0; joint < prismatic.size(); ++joint) {
            const ColumnUnit& unit = columns[std::min(joint, columns.size() - 1)];
            const bool millimetres = unit.name == "mm";
            if (prismatic[joint] && unit.factor != 1 && !millimetres) {
                throw InputError("--units " + quantity + ": expected m or mm for the prismatic joint " +
                                 std::to_string(joint + 1) + ", found a unit of angles");
            }
            if (!prismatic[joint] && millimetres) {
                throw InputError("--units " + quantity + ": expected a unit of angles for joint " +
                                 std::to_string(joint + 1) +
                                 ", which turns, found mm (mrad are thousandths of a radian)");
            }
        }
    }
}

double likely_time_unit(double first_time) {
    const double magnitude = std::abs(first_time);
    if (magnitude >= 1e17) {
        return 1e-9;
    }
    if (magnitude >= 1e14) {
        return 1e-6;
    }
    return magnitude >= 1e11 ? 1e-3 : 1;
}

std::optional<TimeValue> time_value(double value, std::string_view text, double unit_s) {
    constexpr double longest_s = 9.2e9; // int64 nanoseconds end at 9.223e9 s
    const double seconds = value * unit_s;
    if (std::abs(seconds) > longest_s) {
        return std::nullopt;
    }
    std::int64_t whole = 0;
    const char* const end = text.data() + text.size();
    const auto [stop, fault] = std::from_chars(text.data(), end, whole);
    if (unit_s < 1 && stop == end && fault == std::errc{}) {
        return TimeValue{seconds, whole * std::llround(unit_s * 1e9)};
    }
    const double whole_s = std::trunc(seconds); // apart, because a date in nanoseconds exceeds 53 bits
    return TimeValue{seconds,
                     std::llround(whole_s) * 1'000'000'000 + std::llround((seconds - whole_s) * 1e9)};
}

} // namespace dfdyn::tools
