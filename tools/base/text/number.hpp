// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace dfdyn::tools {

enum class NumberFault { none, not_a_number, out_of_range };

struct ParsedNumber {
    double value = 0.0; ///< meaningful only where `fault` is `none`
    NumberFault fault = NumberFault::none;
};

/// Reads the whole of `text` as a decimal number (`-1.5`, `+2`, `1e-3`), whatever the locale. `out_of_range`:
/// infinite, nan, or not representable as a double (`1e999`). Anything else, hexadecimal and empty text
/// included, is `not_a_number`.
ParsedNumber parse_number(std::string_view text) noexcept;

/// The shortest decimal text that `parse_number` reads back as the same double; `nan` and `inf` where it is
/// not finite.
std::string number_text(double value);

/// `value` as printf's `format` of one double writes it, up to 63 characters.
std::string formatted(const char* format, double value);

/// Three significant digits: `0.0123`, `8.02`, `1.2e+04`.
std::string rounded_text(double value);

/// A share in percent, three significant digits: `12.3 %`.
std::string percent(double share);

} // namespace dfdyn::tools
