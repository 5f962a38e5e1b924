// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/socketcan_bus.hpp"

#include "tests/support/catch.hpp"
#include "tests/vcan/peer.hpp"

#include <array>
#include <chrono>
#include <ctime>
#include <thread>
#include <vector>

namespace {

using dfdyn::hal::Frame;
using dfdyn::hal::SocketCanBus;
using dfdyn::hal::StampSource;
using dfdyn::tests::empty;
using dfdyn::tests::on_vcan0;
using dfdyn::tests::receive;

void set_wall_clock_by(std::int64_t seconds) {
    timespec time{};
    REQUIRE(::clock_gettime(CLOCK_REALTIME, &time) == 0);
    time.tv_sec += seconds;
    REQUIRE(::clock_settime(CLOCK_REALTIME, &time) == 0);
}

} // namespace

TEST_CASE("setting the wall clock does not change the stamps") {
    if (!dfdyn::tests::own_machine()) {
        WARN("not judged: the clock of this machine is not ours to set");
        return;
    }
    const std::int64_t step_s = GENERATE(3600, -3600, -2, 2);
    CAPTURE(step_s);
    SocketCanBus bus(on_vcan0());
    SocketCanBus peer(on_vcan0());
    empty(bus);
    std::array<std::int64_t, 4> sent_ns{}; // before the first frame and after each
    sent_ns[0] = bus.now_ns();
    peer.send(Frame{});
    sent_ns[1] = bus.now_ns();
    set_wall_clock_by(step_s);
    sent_ns[2] = bus.now_ns();
    peer.send(Frame{});
    sent_ns[3] = bus.now_ns();
    const std::vector<Frame> frames = receive(bus, 2);
    REQUIRE(frames.size() == 2);
    // The two clocks are read one after the other, so a stamp is wrong by at most the time in between.
    constexpr std::int64_t between_ns = 1'000'000;
    for (std::size_t index = 0; index < 2; ++index) {
        CAPTURE(index);
        CHECK(frames[index].stamp_source == StampSource::kernel);
        CHECK(frames[index].stamp_ns > sent_ns.at(2 * index) - between_ns);
        CHECK(frames[index].stamp_ns < sent_ns.at(2 * index + 1) + between_ns);
    }
    set_wall_clock_by(-step_s);
}

TEST_CASE("fault 28: frames that wait together keep their own stamps") {
    SocketCanBus bus(on_vcan0());
    SocketCanBus peer(on_vcan0());
    empty(bus);
    constexpr std::int64_t apart_ns = 20'000'000;
    std::array<std::int64_t, 3> sent_ns{};
    for (std::int64_t& time_ns : sent_ns) {
        time_ns = bus.now_ns();
        peer.send(Frame{});
        std::this_thread::sleep_for(std::chrono::nanoseconds(apart_ns));
    }
    const std::vector<Frame> frames = receive(bus, 3);
    REQUIRE(frames.size() == 3);
    for (std::size_t index = 0; index < 3; ++index) {
        CHECK(frames[index].stamp_source == StampSource::kernel);
        CHECK(frames[index].stamp_ns > sent_ns.at(index) - 1'000'000);
        CHECK(frames[index].stamp_ns < sent_ns.at(index) + apart_ns);
    }
}
