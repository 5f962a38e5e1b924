// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dfdyn::tools {

/// Requests a real-time priority and locked memory. Returns what the system refused, and why.
std::string become_real_time();

/// Sleeps until the monotonic clock reaches `due_ns` or a signal arrives.
void sleep_until(std::int64_t due_ns);

} // namespace dfdyn::tools
