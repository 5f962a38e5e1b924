// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace dfdyn::tools {

enum class NumberFault { none, not_a_number, out_of_range };

struct ParsedNumber {
    double value = 0.0; ///< valid only if `fault` is `none`
    NumberFault fault = NumberFault::none;
};

/// Reads the whole of `text` as a decimal number (`-1.5`, `+2`, `1e-3`), independent of the locale.
/// `out_of_range`: infinite, nan, or not representable as a double (`1e999`). Any other text, including
/// hexadecimal and empty text, is `not_a_number`.
ParsedNumber parse_number(std::string_view text) noexcept;

/// Returns the shortest decimal text that `parse_number` converts back to the same double; `nan` or `inf` for
/// values that are not finite.
std::string number_text(double value);

/// Returns `value` formatted by printf with `format`, up to 63 characters.
[[gnu::format(printf, 1, 0)]] std::string formatted(const char* format, double value);

/// Does the same; a dash for NaN.
[[gnu::format(printf, 1, 0)]] std::string formatted_or_dash(const char* format, double value);

/// Formats with three significant digits: `0.0123`, `8.02`, `1.2e+04`.
std::string rounded_text(double value);

/// Formats a share in percent with three significant digits: `12.3 %`.
std::string percent(double share);

} // namespace dfdyn::tools
