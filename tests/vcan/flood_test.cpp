// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/candump.hpp"
#include "dfdyn/hal/socketcan_bus.hpp"

#include "tests/support/catch.hpp"
#include "tests/vcan/peer.hpp"

#include <algorithm>
#include <array>
#include <csignal>
#include <sstream>
#include <string>

namespace {

using dfdyn::hal::CandumpLine;
using dfdyn::hal::Frame;
using dfdyn::hal::SendResult;
using dfdyn::hal::SocketCanBus;
using dfdyn::tests::Background;
using dfdyn::tests::on_vcan0;
using dfdyn::tests::receive;
using dfdyn::tests::run;

struct Logged {
    std::uint64_t frames = 0;
    std::uint64_t dropped = 0;
};

Logged count(const std::string& log) {
    std::istringstream lines(log);
    Logged logged;
    for (std::string text; std::getline(lines, text);) {
        const CandumpLine line = dfdyn::hal::parse_candump_line(text);
        REQUIRE(line.kind != CandumpLine::Kind::malformed);
        logged.frames += line.kind == CandumpLine::Kind::frame ? 1 : 0;
        logged.dropped += line.dropped;
    }
    return logged;
}

constexpr std::size_t flood = 2000;

/// Floods `interface` while `bus` is not read, then reads the rest. Returns the number of `flood` frames that
/// were read.
std::size_t overrun(SocketCanBus& bus, const std::string& interface) {
    run("cangen " + interface + " -g 0 -n " + std::to_string(flood));
    static std::array<Frame, flood> room;
    const std::size_t waiting = bus.drain(room).size();
    CHECK(waiting < flood);
    run("cansend " + interface + " 001#"); // the count of lost frames arrives with the next frame
    CHECK(receive(bus, 1).size() == 1);
    return waiting;
}

} // namespace

TEST_CASE("frames that were not read in time are counted like by candump") {
    SocketCanBus bus(on_vcan0());
    const Background candump("candump -L -d vcan0");
    candump.signal(SIGSTOP);
    const std::size_t read = overrun(bus, "vcan0");
    CHECK(bus.counters().dropped == flood - read);

    candump.signal(SIGCONT);
    candump.output(read);
    run("cansend vcan0 002#");
    const Logged logged = count(candump.output(read + 2));
    CHECK(logged.dropped > 0);
    CHECK(logged.frames + logged.dropped == flood + 2);
}

TEST_CASE("lost frames are counted once and the count continues after the interface was down") {
    run("ip link add dev vcan4 type vcan && ip link set vcan4 up");
    SocketCanBus bus({.interface = "vcan4", .filters = {}, .receive_own = false});
    std::size_t read = overrun(bus, "vcan4");
    read += overrun(bus, "vcan4");
    CHECK(bus.counters().dropped == 2 * flood - read);
    run("ip link set vcan4 down");
    dfdyn::tests::empty(bus);
    run("ip link set vcan4 up");
    dfdyn::tests::empty(bus);
    read += overrun(bus, "vcan4");
    CHECK(bus.counters().dropped == 3 * flood - read);
    run("ip link del vcan4");
}

TEST_CASE("a drain ends at its bound while frames keep arriving and reports waiting frames") {
    constexpr std::size_t bound = 8;
    SocketCanBus bus(on_vcan0());
    const Background cangen("cangen vcan0 -g 0", Background::Ready::at_once);
    std::array<Frame, bound> room;
    std::uint64_t received = 0;
    std::size_t largest = 0;
    const std::int64_t deadline_ns = bus.now_ns() + 10'000'000'000;
    while (received + bus.counters().dropped < 10'000 && bus.now_ns() < deadline_ns) {
        const std::size_t drained = bus.drain(room).size();
        largest = std::max(largest, drained);
        received += drained;
        REQUIRE(drained <= bound);
    }
    CHECK(received + bus.counters().dropped >= 10'000);
    CHECK(largest == bound);
    CHECK(bus.counters().received == received);
    CHECK(bus.counters().saturated_drains > 0);
}

TEST_CASE("a full queue rejects a frame at once and counts it") {
    run("ip link add dev vcan2 type vcan && ip link set vcan2 up && "
        "tc qdisc add dev vcan2 root netem delay 60s limit 5");
    SocketCanBus bus({.interface = "vcan2", .filters = {}, .receive_own = false});
    int sent = 0;
    for (int frame = 0; frame < 8; ++frame) {
        sent += bus.send(Frame{}) == SendResult::sent ? 1 : 0;
    }
    CHECK(sent == 5);
    CHECK(bus.send(Frame{}) == SendResult::refused);
    CHECK(bus.counters().sent == 5);
    CHECK(bus.counters().send_refused == 4);
    CHECK(bus.state() == dfdyn::hal::BusState::active);
    run("ip link del vcan2");
}
