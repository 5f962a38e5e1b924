// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/decoded.hpp"

#include <algorithm>
#include <initializer_list>
#include <utility>

namespace dfdyn::tests {

/// Returns a classic data frame with these bytes.
inline hal::Frame frame_of(std::uint32_t id, std::initializer_list<std::uint8_t> bytes,
                           std::int64_t stamp_ns = 0) {
    hal::Frame frame = hal::make_frame(id, static_cast<int>(bytes.size()));
    std::copy(bytes.begin(), bytes.end(), frame.data.begin());
    frame.stamp_ns = stamp_ns;
    return frame;
}

inline hal::Frame at_time(hal::Frame frame, std::int64_t stamp_ns) {
    frame.stamp_ns = stamp_ns;
    return frame;
}

/// Returns the frame with another length.
inline hal::Frame with_length(hal::Frame frame, int length) {
    frame.length = static_cast<std::uint8_t>(length);
    return frame;
}

/// Variants of a frame that no device sends on its identifier: other lengths, remote, CAN FD. `nothing` is
/// the result for extended and error frames, which do not have this identifier. `request` is the result for a
/// remote frame.
template <class Device>
bool rejects_malformed(Device device, const hal::Frame& good, std::initializer_list<int> lengths,
                       hal::Decoded::Kind request = hal::Decoded::Kind::rejected) {
    using Kind = hal::Decoded::Kind;
    bool all = true;
    for (int length = 0; length <= 8; ++length) {
        const bool known = std::find(lengths.begin(), lengths.end(), length) != lengths.end();
        const hal::Decoded decoded = Device(device).decode(with_length(good, length));
        all = all && (known ? decoded.kind != Kind::rejected
                            : decoded.kind == Kind::rejected && decoded.reason == hal::Reason::wrong_length);
    }
    hal::Frame remote = good;
    remote.remote = true;
    hal::Frame flexible = good;
    flexible.fd = true;
    for (const auto& [wrong, kind] : {std::pair(remote, request), std::pair(flexible, Kind::rejected)}) {
        const hal::Decoded decoded = Device(device).decode(wrong);
        all = all && decoded.kind == kind &&
              (kind == Kind::nothing || decoded.reason == hal::Reason::wrong_frame_type);
    }
    hal::Frame extended = good;
    extended.extended = true;
    hal::Frame error = good;
    error.error = true;
    return all && Device(device).decode(extended).kind == Kind::nothing &&
           Device(device).decode(error).kind == Kind::nothing;
}

} // namespace dfdyn::tests
