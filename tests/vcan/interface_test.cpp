// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/socketcan_bus.hpp"

#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/vcan/peer.hpp"

#include <array>
#include <filesystem>
#include <string>

namespace {

using dfdyn::hal::BusError;
using dfdyn::hal::BusState;
using dfdyn::hal::Frame;
using dfdyn::hal::SendResult;
using dfdyn::hal::SocketCanBus;
using dfdyn::hal::SocketCanOptions;
using dfdyn::tests::receive;
using dfdyn::tests::run;

/// A virtual CAN interface that only this test uses.
class Interface {
  public:
    Interface() { add(); }
    ~Interface() {
        if (there_) {
            remove();
        }
    }
    Interface(const Interface&) = delete;
    Interface& operator=(const Interface&) = delete;

    void add() {
        run("ip link add dev vcan3 type vcan && ip link set vcan3 mtu 72 up");
        there_ = true;
    }
    void remove() {
        run("ip link del vcan3");
        there_ = false;
    }
    static void down() { run("ip link set vcan3 down"); }
    static void up() { run("ip link set vcan3 up"); }

  private:
    bool there_ = false;
};

SocketCanOptions on_vcan3() {
    return {.interface = "vcan3",
            .filters = {{.id = 0x120, .mask = 0x7f0, .extended = false}},
            .receive_own = false};
}

BusState state_after_drain(SocketCanBus& bus) {
    std::array<Frame, 16> room;
    bus.drain(room);
    return bus.state();
}

/// Whether `bus` receives 123 but not 456, both sent by cansend.
bool receives_what_its_filter_passes(SocketCanBus& bus) {
    run("cansend vcan3 456# && cansend vcan3 123#");
    const std::vector<Frame> frames = receive(bus, 1);
    return frames.size() == 1 && frames[0].id == 0x123;
}

std::size_t open_files() {
    const std::filesystem::directory_iterator files("/proc/self/fd");
    return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

} // namespace

TEST_CASE("an interface that goes down is distinguished from a silent one and the bus returns with it") {
    Interface interface;
    SocketCanBus bus(on_vcan3());
    CHECK(state_after_drain(bus) == BusState::active);
    const std::size_t files = open_files();
    for (std::uint64_t times = 1; times <= 3; ++times) {
        Interface::down();
        CHECK(state_after_drain(bus) == BusState::interface_down);
        CHECK(state_after_drain(bus) == BusState::interface_down);
        CHECK(bus.counters().interface_down == times);
        CHECK(bus.send(Frame{}) == SendResult::bus_closed);
        Interface::up();
        CHECK(state_after_drain(bus) == BusState::active);
        CHECK(receives_what_its_filter_passes(bus));
        CHECK(bus.send(Frame{}) == SendResult::sent);
    }
    CHECK(open_files() == files);
}

TEST_CASE("frames that wait while the interface goes down are still received") {
    Interface interface;
    SocketCanBus bus(on_vcan3());
    run("cansend vcan3 121# && cansend vcan3 122#");
    Interface::down();
    std::array<Frame, 16> room;
    CHECK(bus.drain(room).size() == 2);
    CHECK(bus.state() == BusState::interface_down);
}

TEST_CASE("a bus-off that waits while the interface goes down does not hide that") {
    Interface interface;
    SocketCanBus bus(on_vcan3());
    dfdyn::tests::RawSocket("vcan3").send(0x20000040, {0, 0, 0, 0, 0, 0, 0, 0});
    Interface::down();
    CHECK(state_after_drain(bus) == BusState::interface_down);
    CHECK(bus.counters().error_frames == 1);
    Interface::up();
    CHECK(state_after_drain(bus) == BusState::active);
}

TEST_CASE("sending on an interface that is down returns that reason") {
    Interface interface;
    SocketCanBus bus(on_vcan3());
    Interface::down();
    CHECK(bus.send(Frame{}) == SendResult::bus_closed);
    CHECK(bus.state() == BusState::interface_down);
    Interface::up();
    CHECK(state_after_drain(bus) == BusState::active);
    CHECK(bus.send(Frame{}) == SendResult::sent);
}

TEST_CASE("an interface that is unplugged and plugged in again is reopened without the heap") {
    Interface interface;
    SocketCanBus bus(on_vcan3());
    interface.remove();
    CHECK(state_after_drain(bus) == BusState::interface_down);
    CHECK(state_after_drain(bus) == BusState::interface_down);
    CHECK(bus.counters().interface_down == 1);
    interface.add();
    const dfdyn::tests::AllocationGuard guard;
    const BusState state = state_after_drain(bus);
    const auto calls = guard.calls();
    CHECK(state == BusState::active);
    CHECK(calls.allocations == 0);
    CHECK(receives_what_its_filter_passes(bus));
}

TEST_CASE("a bus opens on an interface that is down and receives after it comes up") {
    Interface interface;
    Interface::down();
    SocketCanBus bus(on_vcan3());
    CHECK(bus.state() == BusState::interface_down);
    CHECK(state_after_drain(bus) == BusState::interface_down);
    CHECK(bus.counters().interface_down == 1);
    Interface::up();
    CHECK(state_after_drain(bus) == BusState::active);
    CHECK(receives_what_its_filter_passes(bus));
}

TEST_CASE("an interface that cannot be opened is rejected with its name and the reason") {
    using Catch::Matchers::Message;
    const auto open = [](const std::string& name) {
        SocketCanBus({.interface = name, .filters = {}, .receive_own = false});
    };
    CHECK_THROWS_MATCHES(open("none"), BusError,
                         Message("none: expected a CAN interface of this name, found: No such device"));
    CHECK_THROWS_MATCHES(open("lo"), BusError,
                         Message("lo: expected a CAN interface, found: an interface of another kind"));
    CHECK_THROWS_MATCHES(open(""), BusError,
                         Message("CAN interface: expected a name of 1 to 15 characters, found 0"));
    CHECK_THROWS_MATCHES(open(std::string(16, 'x')), BusError,
                         Message("CAN interface: expected a name of 1 to 15 characters, found 16"));
}
