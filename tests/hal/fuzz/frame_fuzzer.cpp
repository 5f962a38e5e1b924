// SPDX-License-Identifier: Apache-2.0
// Decodes frames from 14 bytes each: id (2 bytes), flags and length, step of the time stamp, step of the
// time, 8 bytes of data.
#include "tests/hal/fuzz/assemblies.hpp"

#include <cstdlib>

namespace {

constexpr std::size_t bytes_per_frame = 14;

dfdyn::hal::Frame frame_from(const std::uint8_t* bytes) {
    dfdyn::hal::Frame frame;
    frame.id = dfdyn::hal::load_little<std::uint16_t>(bytes) & 0x7FFU;
    frame.extended = (bytes[1] & 0x80) != 0;
    frame.length = bytes[2] & 0x0F;
    frame.remote = (bytes[2] & 0x10) != 0;
    frame.fd = (bytes[2] & 0x20) != 0;
    frame.error = (bytes[2] & 0x40) != 0;
    std::copy_n(bytes + 6, 8, frame.data.begin());
    return frame;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    dfdyn::tests::EveryArm arms;
    std::int64_t now_ns = 1'000'000'000'000;
    for (std::size_t at = 0; at + bytes_per_frame <= size; at += bytes_per_frame) {
        dfdyn::hal::Frame frame = frame_from(data + at);
        now_ns += 1000 * data[at + 5];
        const auto behind = static_cast<std::int8_t>(data[at + 3]);
        frame.stamp_ns = now_ns - (std::int64_t{behind} << (data[at + 4] & 0x3F) % 48);
        if (!arms.take(frame, now_ns)) {
            std::abort();
        }
    }
    return 0;
}
