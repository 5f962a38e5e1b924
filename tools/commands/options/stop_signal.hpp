// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace dfdyn::tools {

/// From now on Ctrl-C, SIGTERM and SIGHUP set the result, end a sleep, and nothing else.
const std::atomic<bool>& stop_on_signals();

/// From now on SIGUSR1 turns the result over, true and false, and ends a sleep.
const std::atomic<bool>& toggle_on_signal();

} // namespace dfdyn::tools
