// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace dfdyn::tools {

/// Asks for a real-time priority and for memory that stays; returns what was not granted, and why.
std::string become_real_time();

/// Sleeps until the monotonic clock shows `due_ns`, or a signal comes.
void sleep_until(std::int64_t due_ns);

} // namespace dfdyn::tools
