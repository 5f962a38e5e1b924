// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace dfdyn::tools {

/// Returns the time of a stamp in a recording, s: the recording's times are those of the samples' clock plus
/// `origin_s`.
constexpr double recorded_time_s(double origin_s, std::int64_t time_ns) {
    return origin_s + 1e-9 * static_cast<double>(time_ns);
}

} // namespace dfdyn::tools
