// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>

namespace dfdyn::tools {

/// From now on Ctrl-C, SIGTERM and SIGHUP set the result, end a sleep, and nothing else.
const std::atomic<bool>& stop_on_signals();

} // namespace dfdyn::tools
