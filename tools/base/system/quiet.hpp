// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dfdyn::tools {

/// Suppresses progress lines and notes on standard error from now on; warnings and errors remain.
void be_quiet() noexcept;

/// Returns whether be_quiet() was called.
bool quiet() noexcept;

} // namespace dfdyn::tools
