// SPDX-License-Identifier: Apache-2.0
#include "tools/control/bus/plant_port.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/control/bus/scripted_bus.hpp"
#include "tests/tools/control/pendulum.hpp"

#include <algorithm>

namespace plant_port_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
namespace hal = dfdyn::hal;

/// The command frame for a drive torque in N·m.
hal::Frame command(double torque) {
    TorqueFrames frames(one_drive(at_sync));
    return frames.encode({&torque, 1})[0];
}

SimulatedPlant resting_plant() {
    return {test_pendulum(), pendulum_scenario(), JointVector::Constant(1, 0.3)};
}

std::int64_t count_of(const ScriptedBus& bus, std::uint32_t id) {
    return std::ranges::count_if(bus.taken, [id](const hal::Frame& frame) { return frame.id == id; });
}

TEST_CASE("drives hold a command for 20 ms and then apply no torque until the next command") {
    PlantPort port(one_drive(at_sync), {});
    ScriptedBus bus;
    CHECK(port.torque(0)[0] == 0);
    bus.waiting = {command(5)};
    port.receive(bus);
    CHECK(port.torque(bus.time_ns)[0] == 5);
    CHECK(port.torque(20'000'000)[0] == 5);
    CHECK(port.timeouts() == 0);
    CHECK(port.torque(20'000'001)[0] == 0);
    CHECK(port.torque(40'000'000)[0] == 0);
    CHECK(port.timeouts() == 1);
    bus.time_ns = 50'000'000;
    bus.waiting = {command(-3)};
    port.receive(bus);
    CHECK(port.torque(bus.time_ns)[0] == -3);
    CHECK(port.commands() == 2);
}

TEST_CASE("a plant's devices send SYNC and position and torque in every tick and ten heartbeats a second") {
    PlantPort port(one_drive(at_sync), {});
    SimulatedPlant plant = resting_plant();
    plant.apply(JointVector::Constant(1, 2));
    ScriptedBus bus;
    for (int tick = 0; tick < 200; ++tick) {
        port.send(bus, plant);
        bus.time_ns += 1'000'000;
    }
    CHECK(count_of(bus, 0x080) == 200);
    CHECK(count_of(bus, 0x281) == 200);
    CHECK(count_of(bus, 0x701) == 2);
    const hal::Frame& last = bus.taken.back();
    REQUIRE(last.length == 6);
    const int counts = last.data[0] + 256 * last.data[1] + 65536 * last.data[2];
    CHECK(counts == Approx(0.3 / (2 * 3.14159265358979) * 1048576).margin(1));
    CHECK(last.data[4] + 256 * last.data[5] == 2000); // in units of 0.001 N·m
    CHECK(port.refused() == 0);
}

TEST_CASE("drives that measure currents send the torque divided by the torque constant") {
    TorqueSensorModel sensor;
    sensor.torque_constant = JointVector::Constant(1, 4);
    PlantPort port(one_drive(at_sync, "i"), sensor);
    SimulatedPlant plant = resting_plant();
    plant.apply(JointVector::Constant(1, 2));
    ScriptedBus bus;
    port.send(bus, plant);
    const hal::Frame& last = bus.taken.back();
    CHECK(last.data[4] + 256 * last.data[5] == 500);
}

TEST_CASE("frames that are not commands change nothing and frames that do not fit on the bus are counted") {
    PlantPort port(one_drive(at_sync), {});
    ScriptedBus bus;
    hal::Frame other = command(5);
    other.id = 0x202; // the command of another node
    hal::Frame longer = command(5);
    longer.length = 3;
    bus.waiting = {other, longer};
    port.receive(bus);
    CHECK(port.commands() == 0);
    CHECK(port.torque(0)[0] == 0);
    SimulatedPlant plant = resting_plant();
    bus.room = 1;
    port.send(bus, plant);
    CHECK(port.refused() == 2); // two of SYNC, heartbeat and position
}

} // namespace plant_port_test
