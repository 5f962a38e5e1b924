// SPDX-License-Identifier: Apache-2.0
// A machine that stalls stops a loop, correctly. This says nothing about the loop.
#pragma once

#include <chrono>
#include <functional>

namespace dfdyn::tests {

/// Half of the time without positions after which a loop of 100 Hz stops.
inline constexpr std::chrono::milliseconds may_stop_a_loop{30};

/// Returns whether `attempt` is right. In a kernel that does not keep time, repeats an attempt that is wrong
/// while the machine woke a thread late by `shortest_stall` or more. After too many of these in all tests of
/// this program, returns true and warns that the test was not judged. Check outside of the attempt what holds
/// despite stalls.
bool right_unless_stalled(const std::function<bool()>& attempt,
                          std::chrono::milliseconds shortest_stall = may_stop_a_loop);

} // namespace dfdyn::tests
