// SPDX-License-Identifier: Apache-2.0
// Random frames and frames with random errors.
#include "tests/hal/fuzz/assemblies.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>

namespace hal = dfdyn::hal;
using dfdyn::tests::EveryArm;

namespace {

int pick(std::mt19937_64& engine, int count) {
    return std::uniform_int_distribution<int>(0, count - 1)(engine);
}

/// A random frame, mostly with an 11-bit identifier.
hal::Frame random_frame(std::mt19937_64& engine) {
    hal::Frame frame;
    frame.id = static_cast<std::uint32_t>(engine()) & (pick(engine, 8) == 0 ? 0x1FFFFFFFU : 0x7FFU);
    frame.extended = frame.id > 0x7FF || pick(engine, 50) == 0;
    frame.length = static_cast<std::uint8_t>(pick(engine, pick(engine, 50) == 0 ? 65 : 9));
    for (std::size_t i = 0; i < frame.length; ++i) {
        frame.data[i] = static_cast<std::uint8_t>(engine());
    }
    return frame;
}

void mutate(hal::Frame& frame, std::mt19937_64& engine) {
    switch (pick(engine, 8)) {
    case 0:
        frame.length = static_cast<std::uint8_t>(pick(engine, 9));
        break;
    case 1:
        frame.remote = true;
        break;
    case 2:
        frame.fd = true;
        break;
    case 3:
        frame.error = true;
        break;
    case 4:
        frame.origin = static_cast<hal::Origin>(pick(engine, 3));
        break;
    default:
        frame.data[static_cast<std::size_t>(pick(engine, 8))] = static_cast<std::uint8_t>(engine());
        break;
    }
}

/// A random time stamp: mostly now, sometimes any number.
std::int64_t random_stamp(std::int64_t now_ns, std::mt19937_64& engine) {
    switch (pick(engine, 1000)) {
    case 0:
        return static_cast<std::int64_t>(engine());
    case 1:
        return now_ns - pick(engine, 1'000'000'000);
    case 2:
        return now_ns + pick(engine, 1'000'000'000);
    default:
        return now_ns - pick(engine, 100'000);
    }
}

} // namespace

TEST_CASE("random frames never give a valid sample beyond the range of its sensors") {
    DFDYN_SEEDED_ENGINE(engine);
    EveryArm arms;
    std::int64_t now_ns = 1'000'000'000'000;
    bool sound = true;
    int taken = 0;
    for (int round = 0; taken < 1'000'000; ++round) {
        const double size = 2.5 * std::sin(1e-3 * round) + 0.01;
        for (const hal::Frame& good : arms.good_frames(size)) {
            hal::Frame frame = pick(engine, 4) == 0 ? random_frame(engine) : good;
            if (pick(engine, 10) == 0) {
                mutate(frame, engine);
            }
            now_ns += pick(engine, 120'000);
            frame.stamp_ns = random_stamp(now_ns, engine);
            sound = arms.take(frame, now_ns) && sound;
            ++taken;
        }
    }
    CHECK(sound);
    CHECK(arms.samples() > 100'000); // the test must not pass by giving no samples
    CHECK(arms.outputs() > 20);      // several agreeing values are needed, which is rare here
}

TEST_CASE("frames and samples cause no allocation") {
    EveryArm arms;
    const std::vector<hal::Frame> frames = arms.good_frames(0.5);
    const dfdyn::tests::AllocationGuard guard;
    for (int i = 0; i < 100; ++i) {
        for (hal::Frame frame : frames) {
            frame.stamp_ns = i * dfdyn::tests::fuzz_ms;
            arms.take(frame, i * dfdyn::tests::fuzz_ms + 1000);
        }
    }
    const dfdyn::tests::HeapCalls calls = guard.calls();
    CHECK(calls.allocations == 0);
    CHECK(arms.samples() > 0);
}
