// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/number.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <system_error>

namespace dfdyn::tools {

ParsedNumber parse_number(std::string_view text) noexcept {
    if (text.starts_with('+') && !text.starts_with("+-")) {
        text.remove_prefix(1); // std::from_chars accepts no plus, but printf("%+f") writes one
    }
    double value = 0.0;
    const char* const end = text.data() + text.size();
    const auto [stop, fault] = std::from_chars(text.data(), end, value);
    if (stop != end || fault == std::errc::invalid_argument) {
        return {value, NumberFault::not_a_number};
    }
    if (fault == std::errc::result_out_of_range || !std::isfinite(value)) {
        return {value, NumberFault::out_of_range};
    }
    return {value, NumberFault::none};
}

std::string number_text(double value) {
    std::array<char, 32> buffer{}; // the longest result, -2.2250738585072014e-308, has 24 characters
    const auto [end, fault] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    static_cast<void>(fault);
    return {buffer.data(), end};
}

std::string formatted(const char* format, double value) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), format, value);
    return text.data();
}

std::string formatted_or_dash(const char* format, double value) {
    return std::isnan(value) ? "-" : formatted(format, value);
}

std::string rounded_text(double value) { return formatted("%.3g", value); }

std::string percent(double share) { return rounded_text(100 * share) + " %"; }

} // namespace dfdyn::tools
