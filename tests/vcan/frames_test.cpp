// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/candump.hpp"
#include "dfdyn/hal/socketcan_bus.hpp"

#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random_frame.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/vcan/peer.hpp"

#include <array>
#include <sstream>
#include <string>
#include <vector>

namespace {

using dfdyn::hal::BusState;
using dfdyn::hal::CandumpLine;
using dfdyn::hal::CandumpText;
using dfdyn::hal::Frame;
using dfdyn::hal::Origin;
using dfdyn::hal::SendResult;
using dfdyn::hal::SocketCanBus;
using dfdyn::hal::StampDecimals;
using dfdyn::hal::StampSource;
using dfdyn::tests::Background;
using dfdyn::tests::content;
using dfdyn::tests::on_vcan0;
using dfdyn::tests::RawSocket;
using dfdyn::tests::receive;
using dfdyn::tests::run;
using dfdyn::tests::wait_for;

static_assert(dfdyn::hal::Bus<SocketCanBus>);

/// Random frames of all kinds that can be sent.
std::vector<Frame> random_frames(std::mt19937_64& engine, std::size_t count) {
    std::vector<Frame> frames;
    while (frames.size() < count) {
        const Frame frame = dfdyn::tests::random_frame(engine);
        if (!frame.error) {
            frames.push_back(frame);
        }
    }
    return frames;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) {
        lines.push_back(line);
    }
    return lines;
}

Frame classic(std::uint32_t id) {
    Frame frame;
    frame.id = id;
    return frame;
}

} // namespace

TEST_CASE("frames from cansend are received and stamped by the kernel") {
    SocketCanBus bus(on_vcan0());
    const std::string texts[] = {
        "123#DEADBEEF", "7FF#",   "00000001#0011223344556677",      "1FFFFFFF#01",         "123#R",
        "123#R4",       "123##0", "123##1" + std::string(128, 'A'), "12345678##311223344",
    };
    for (const std::string& text : texts) {
        CAPTURE(text);
        const std::int64_t before_ns = bus.now_ns();
        run("cansend vcan0 '" + text + "'");
        const std::vector<Frame> frames = receive(bus, 1);
        REQUIRE(frames.size() == 1);
        const std::string line = "(0.000000) vcan0 " + text;
        CHECK(content(frames[0]) == content(dfdyn::hal::parse_candump_line(line).frame));
        CHECK(frames[0].stamp_source == StampSource::kernel);
        CHECK(frames[0].stamp_ns > before_ns);
        CHECK(frames[0].stamp_ns < bus.now_ns());
        CHECK(frames[0].origin == Origin::this_host);
    }
    CHECK(bus.counters().received == std::size(texts));
    CHECK(bus.counters().dropped == 0);
}

TEST_CASE("candump prints sent frames as the candump writer does") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<Frame> sent = random_frames(engine, 100);
    SocketCanBus bus(on_vcan0());
    const Background candump("candump -L vcan0");
    for (const Frame& frame : sent) {
        REQUIRE(bus.send(frame) == SendResult::sent);
    }
    CHECK(bus.counters().sent == sent.size());
    const std::vector<std::string> lines = lines_of(candump.output(sent.size()));
    REQUIRE(lines.size() == sent.size());
    for (std::size_t index = 0; index < sent.size(); ++index) {
        CAPTURE(lines[index]);
        const CandumpLine read = dfdyn::hal::parse_candump_line(lines[index]);
        REQUIRE(read.kind == CandumpLine::Kind::frame);
        CHECK(content(read.frame) == content(sent[index]));
        if (!read.frame.fd) { // newer kernels also mark CAN FD in its flags
            CandumpText text{};
            CHECK(write_candump_line(read.frame, "vcan0", StampDecimals::microseconds, text) == lines[index]);
        }
    }
}

TEST_CASE("canplayer plays a written log and candump -x shows the sender") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<Frame> frames = random_frames(engine, 100);
    std::string log;
    for (Frame frame : frames) {
        frame.stamp_ns = 1'000'000'000;
        CandumpText text{};
        log.append(write_candump_line(frame, "can7", StampDecimals::microseconds, text)).append("\n");
    }
    const dfdyn::tests::TemporaryDirectory directory;
    SocketCanBus bus(on_vcan0());
    const Background candump("candump -L -x vcan0");
    run("canplayer -I '" + directory.write("frames.log", log).string() + "' vcan0=can7");
    const std::vector<Frame> received = receive(bus, frames.size());
    REQUIRE(received.size() == frames.size());
    const std::vector<std::string> lines = lines_of(candump.output(frames.size()));
    REQUIRE(lines.size() == frames.size());
    for (std::size_t index = 0; index < frames.size(); ++index) {
        CHECK(content(received[index]) == content(frames[index]));
        CHECK(content(dfdyn::hal::parse_candump_line(lines[index]).frame) == content(frames[index]));
        CHECK(dfdyn::hal::parse_candump_line(lines[index]).frame.origin == Origin::this_host);
    }
}

TEST_CASE("a bus receives its own frames only on request and marks them") {
    SocketCanBus silent(on_vcan0());
    dfdyn::hal::SocketCanOptions options = on_vcan0();
    options.receive_own = true;
    SocketCanBus bus(options);
    REQUIRE(bus.send(classic(1)) == SendResult::sent);
    REQUIRE(silent.send(classic(2)) == SendResult::sent);
    const std::vector<Frame> frames = receive(bus, 2);
    REQUIRE(frames.size() == 2);
    CHECK(frames[0].id == 1);
    CHECK(frames[0].origin == Origin::this_socket);
    CHECK(frames[1].id == 2);
    CHECK(frames[1].origin == Origin::this_host);
    const std::vector<Frame> of_others = receive(silent, 1);
    REQUIRE(of_others.size() == 1);
    CHECK(of_others[0].id == 1);
    std::array<Frame, 4> room;
    CHECK(silent.drain(room).empty());
}

TEST_CASE("filters pass only matching identifiers of their kind") {
    dfdyn::hal::SocketCanOptions options = on_vcan0();
    options.filters = {{.id = 0x120, .mask = 0x7f0, .extended = false},
                       {.id = 0x12345, .mask = 0x1fffffff, .extended = true}};
    SocketCanBus bus(options);
    run("for f in 11F 120 12F 130 00000120 00012345 00012346 123; do cansend vcan0 $f#; done");
    const std::vector<Frame> frames = receive(bus, 4);
    REQUIRE(frames.size() == 4);
    CHECK(frames[0].id == 0x120);
    CHECK(frames[1].id == 0x12f);
    CHECK(frames[2].id == 0x12345);
    CHECK(frames[3].id == 0x123);
}

TEST_CASE("error frames pass every filter and update state and counters") {
    dfdyn::hal::SocketCanOptions options = on_vcan0();
    options.filters = {{.id = 0x7ff, .mask = 0x7ff, .extended = false}};
    SocketCanBus bus(options);
    const RawSocket controller("vcan0");
    const auto report = [&](std::uint32_t classes, std::uint8_t detail) {
        REQUIRE(controller.send(0x20000000U | classes, {0, detail, 0, 0, 0, 0, 0, 0}));
        const std::vector<Frame> frames = receive(bus, 1);
        REQUIRE(frames.size() == 1);
        CHECK(frames[0].error);
        CHECK(frames[0].id == classes);
        CHECK(frames[0].length == 8);
        return bus.state();
    };
    CHECK(report(0x002, 0) == BusState::active);
    CHECK(report(0x004, 0x08) == BusState::warning);
    CHECK(report(0x004, 0x20) == BusState::passive);
    CHECK(report(0x040, 0) == BusState::off);
    CHECK(bus.send(classic(1)) == SendResult::bus_closed);
    CHECK(report(0x100, 0) == BusState::active);
    CHECK(bus.send(classic(1)) == SendResult::sent);
    CHECK(report(0x004, 0x01) == BusState::active);
    CHECK(bus.counters().error_frames == 6);
    CHECK(bus.counters().lost_arbitrations == 1);
    CHECK(bus.counters().bus_off == 1);
    CHECK(bus.counters().restarted == 1);
    CHECK(bus.counters().controller_overruns == 1);
}

TEST_CASE("frames that the bus cannot carry are not sent") {
    SocketCanBus bus(on_vcan0());
    Frame error = classic(0x40);
    error.error = true;
    CHECK(bus.send(error) == SendResult::invalid);
    CHECK(bus.send(classic(0x800)) == SendResult::invalid);
    CHECK(bus.counters().sent == 0);

    run("ip link add dev vcan1 type vcan && ip link set vcan1 mtu 16 up");
    SocketCanBus classic_bus({.interface = "vcan1", .filters = {}, .receive_own = false});
    Frame fd = classic(1);
    fd.fd = true;
    CHECK(classic_bus.send(fd) == SendResult::invalid);
    CHECK(classic_bus.send(classic(1)) == SendResult::sent);
    CHECK(classic_bus.state() == BusState::active);
    run("ip link del vcan1");
}

TEST_CASE("no call uses the heap once the bus is open") {
    SocketCanBus bus(on_vcan0());
    SocketCanBus peer(on_vcan0());
    std::array<Frame, 16> room;
    std::size_t received = 0;
    const dfdyn::tests::AllocationGuard guard;
    for (std::uint32_t id = 0; id < 100; ++id) {
        peer.send(classic(id));
        received += bus.drain(room).size();
    }
    // A busy kernel delivers the frames later from a thread of its own.
    wait_for([&] {
        received += bus.drain(room).size();
        return received >= 100;
    });
    const auto calls = guard.calls();
    CHECK(received == 100);
    CHECK(calls.allocations == 0);
    CHECK(calls.releases == 0);
}
