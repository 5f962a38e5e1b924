// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/candump.hpp"

#include <string>

namespace dfdyn::tests {

/// All of `frame` except its stamp and origin, as text that differs if frames differ.
inline std::string content(hal::Frame frame) {
    frame.stamp_ns = 0;
    frame.origin = hal::Origin::remote;
    hal::CandumpText text{};
    return std::string(hal::write_candump_line(frame, "bus", hal::StampDecimals::microseconds, text));
}

/// Returns whether all members are equal.
inline bool same(const hal::Frame& one, const hal::Frame& other) {
    return one.stamp_ns == other.stamp_ns && one.id == other.id && one.extended == other.extended &&
           one.remote == other.remote && one.error == other.error && one.fd == other.fd &&
           one.bit_rate_switch == other.bit_rate_switch &&
           one.error_state_indicator == other.error_state_indicator && one.length == other.length &&
           one.origin == other.origin && one.stamp_source == other.stamp_source && one.data == other.data;
}

} // namespace dfdyn::tests
