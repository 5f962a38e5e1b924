// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace dfdyn::tools {

/// Suppresses progress lines and notes on standard error from now on; warnings and errors remain.
void be_quiet() noexcept;

/// Returns whether be_quiet() was called.
bool quiet() noexcept;

/// Prints one line on standard error, unless be_quiet() was called.
void print_note(std::string_view line);

} // namespace dfdyn::tools
