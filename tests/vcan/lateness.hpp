// SPDX-License-Identifier: Apache-2.0
// A machine that stalls stops a loop, correctly. This says nothing about the loop.
#pragma once

#include <functional>

namespace dfdyn::tests {

/// Returns whether `attempt` is right. In a kernel that does not keep time, repeats an attempt that is wrong
/// while the machine stalled. After too many of these in all tests of this program, returns true and warns
/// that the test was not judged. Check outside of the attempt what holds despite stalls.
bool right_unless_stalled(const std::function<bool()>& attempt);

} // namespace dfdyn::tests
