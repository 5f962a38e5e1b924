// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/candump.hpp"
#include "tools/can/log/candump_log.hpp"

#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/temporary_directory.hpp"

#include <array>
#include <chrono>
#include <fstream>
#include <thread>

#include <sys/stat.h>

namespace {

using dfdyn::hal::CandumpText;
using dfdyn::hal::Frame;
using dfdyn::hal::ReplayBus;
using dfdyn::tools::CandumpLog;

constexpr int cycle_frames = 6;
constexpr std::int64_t cycle_ns = 1'000'000;

/// Writes a log of `cycles` control cycles to a pipe, because a file would be too large.
void write_log(const std::filesystem::path& pipe, std::int64_t cycles) {
    std::ofstream out(pipe);
    Frame frame;
    frame.length = 8;
    for (std::int64_t cycle = 0; cycle < cycles; ++cycle) {
        for (int index = 0; index < cycle_frames; ++index) {
            frame.stamp_ns = cycle * cycle_ns + index * 100'000;
            frame.id = static_cast<std::uint32_t>(0x100 + index);
            frame.data[0] = static_cast<std::uint8_t>(cycle);
            CandumpText text{};
            out << write_candump_line(frame, "can0", dfdyn::hal::StampDecimals::microseconds, text) << '\n';
        }
    }
}

} // namespace

TEST_CASE("an hour at 1 kHz with 6 frames each is replayed completely and in order in the memory of its "
          "first second",
          "[.long]") {
    constexpr std::int64_t cycles = 3'600'000;
    const dfdyn::tests::TemporaryDirectory directory;
    const auto pipe = directory.path() / "log";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    std::thread writer([&] { write_log(pipe, cycles); });
    const auto start = std::chrono::steady_clock::now();
    CandumpLog log(pipe);
    ReplayBus bus(log);
    std::array<Frame, 16> room;
    std::int64_t frames = 0;
    std::int64_t wrong = 0;
    const dfdyn::tests::AllocationGuard guard;
    for (std::int64_t cycle = 0; cycle < cycles; ++cycle) {
        bus.advance_to(cycle * cycle_ns + cycle_ns - 1);
        int in_cycle = 0;
        for (const Frame& frame : bus.drain(room)) {
            wrong +=
                frame.stamp_ns / cycle_ns != cycle || frame.id != 0x100U + static_cast<unsigned>(in_cycle);
            ++in_cycle;
        }
        wrong += in_cycle == cycle_frames ? 0 : 1;
        frames += in_cycle;
    }
    const auto calls = guard.calls();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    writer.join();
    CHECK(frames == cycle_frames * cycles);
    CHECK(wrong == 0);
    CHECK(bus.ended());
    CHECK_NOTHROW(log.check());
    CHECK(calls.allocations == 0);
    WARN("replayed 3600 s in " << took.count() << " s, " << 3600.0 / took.count() << " times real time");
}
