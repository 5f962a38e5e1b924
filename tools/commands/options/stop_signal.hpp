// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace dfdyn::tools {

/// Installs handlers for Ctrl-C, SIGTERM and SIGHUP, which set the result and end a sleep.
const std::atomic<bool>& stop_on_signals();

/// Installs a handler for SIGUSR1, which inverts the result and ends a sleep.
const std::atomic<bool>& toggle_on_signal();

} // namespace dfdyn::tools
