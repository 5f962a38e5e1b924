// SPDX-License-Identifier: Apache-2.0
// Faults of bus and timing: frames lost between devices and loop, late ticks, and clocks that jump.
#include "tests/support/catch.hpp"
#include "tests/tools/control/bus/scripted_bus.hpp"
#include "tests/tools/control/pendulum.hpp"
#include "tests/tools/simulation/faults/read_faults.hpp"
#include "tools/base/system/pace.hpp"
#include "tools/control/closed_loop.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace loop_faults_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
namespace hal = dfdyn::hal;

constexpr double period_s = 0.001;

/// One tick, and the position of the arm when it began.
struct Tick {
    double due_s = 0, begun_s = 0;
    std::int64_t measured_ns = 0;
    bool missed = false;
    std::optional<double> position, torque; ///< measured
    double true_position = 0, held = 0;     ///< N·m, of the actuator until this tick's command
    double command = 0, error = 0;

    bool operator==(const Tick&) const = default;
};

Scenario noisy_scenario() {
    Scenario scenario = pendulum_scenario();
    scenario.payloads = {{0, 0.2, Eigen::Vector3d::Zero()}};
    scenario.encoders.noise = 1e-5;
    scenario.torque_sensor.noise = JointVector::Constant(1, 0.1);
    return scenario;
}

std::vector<Tick> run(const std::string& faults, double duration_s, const BusDescription* bus = nullptr,
                      std::uint64_t seed = 1) {
    Scenario scenario = noisy_scenario();
    scenario.seed = seed;
    scenario.faults = faults_of(faults, 1);
    ClosedLoop loop(test_pendulum(), scenario, "test", nullptr, bus);
    std::vector<Tick> ticks;
    loop.run_to(duration_s, [&](const ClosedLoopInstant& instant) {
        const LoopInput& measured = instant.measured;
        Tick tick{instant.time_s, loop.plant().time_s(), measured.time_ns, measured.deadline_missed, {}, {}};
        if (measured.position != nullptr) {
            tick.position = (*measured.position)[0];
        }
        if (measured.torque != nullptr) {
            tick.torque = (*measured.torque)[0];
        }
        tick.true_position = loop.plant().truth().position[0];
        tick.held = loop.plant().truth().torque[0];
        tick.command = instant.command[0];
        tick.error = instant.error[0];
        ticks.push_back(tick);
    });
    return ticks;
}

/// Simulates the arm alone, with the torques of these ticks' commands as the actuator held them.
SimulatedPlant replayed(const std::vector<Tick>& ticks, double until_s) {
    SimulatedPlant plant(test_pendulum(), noisy_scenario(),
                         JointVector::Constant(1, ticks.front().true_position));
    for (std::size_t i = 0; ticks[i].begun_s < until_s; ++i) {
        plant.advance_to(ticks[i].begun_s);
        plant.apply(JointVector::Constant(1, ticks[i + 1].held));
    }
    plant.advance_to(until_s);
    return plant;
}

/// N·m, half of the resolution of a command on the bus.
constexpr double rounding = 0.00051;

bool same_until(const std::vector<Tick>& one, const std::vector<Tick>& other, double time_s) {
    const auto count = static_cast<std::ptrdiff_t>(std::lround(time_s / period_s));
    return std::equal(one.begin(), one.begin() + count, other.begin(), other.begin() + count);
}

TEST_CASE("without faults the loop and the arm alternate between reading and tick and command") {
    const Scenario scenario = noisy_scenario();
    const auto loop = make_control_loop(test_pendulum(), scenario, "test", nullptr);
    SimulatedPlant plant(test_pendulum(), scenario, loop->reference().position);
    for (const Tick& tick : run("[]", 1)) {
        plant.advance_to(tick.due_s);
        const JointVector position = plant.position(), torque = plant.torque();
        LoopInput input;
        input.time_ns = std::llround(tick.due_s * 1e9);
        input.position = &position;
        input.torque = &torque;
        REQUIRE(tick.command == loop->tick(input)[0]);
        REQUIRE(tick.error == loop->reference().position[0] - plant.truth().position[0]);
        REQUIRE(tick.torque == torque[0]);
        plant.apply(JointVector::Constant(1, tick.command));
    }
}

TEST_CASE("without faults the loop and the devices alternate in the same way over their frames") {
    const Scenario scenario = noisy_scenario();
    const BusDescription bus = one_drive(at_sync);
    MemoryBus loop_end, plant_end;
    MemoryBus::join(loop_end, plant_end);
    LoopPort port(bus, period_s);
    PlantPort devices(bus, scenario.torque_sensor);
    const auto loop = make_control_loop(test_pendulum(), scenario, "test", nullptr, port.delay_ticks());
    SimulatedPlant plant(test_pendulum(), scenario, loop->reference().position);
    std::int64_t now_ns = 0;
    for (const Tick& tick : run("[]", 1, &bus)) {
        do {
            plant.advance_to(tick.due_s);
            loop_end.set_time(now_ns);
            plant_end.set_time(now_ns);
            devices.send(plant_end, plant);
            port.receive(loop_end, now_ns);
            loop->tick(port.sense(now_ns));
            now_ns += 1'000'000;
        } while (loop->state() == LoopState::waiting);
        JointVector command = JointVector::Constant(1, tick.command);
        port.send(loop_end, command);
        devices.receive(plant_end);
        plant.apply(devices.torque(loop_end.now_ns()));
        REQUIRE(tick.error == loop->reference().position[0] - tick.true_position);
    }
    CHECK(loop->counters().running == 1000);
}

TEST_CASE("each lost cycle of the devices gives the loop one tick without readings") {
    const BusDescription bus = one_drive(at_sync);
    for (const BusDescription* const link : {static_cast<const BusDescription*>(nullptr), &bus}) {
        const std::vector<Tick> sound = run("[]", 0.4, link);
        const std::vector<Tick> ticks =
            run(R"([{"kind": "cycles_lost", "cycles": 3, "at_s": 0.3}])", 0.4, link);
        CHECK(same_until(ticks, sound, 0.3));
        CHECK(ticks.at(299).position);
        for (std::size_t tick = 300; tick < 303; ++tick) {
            CHECK_FALSE(ticks.at(tick).position);
            CHECK_FALSE(ticks.at(tick).torque);
        }
        CHECK(ticks.at(303).position);
        CHECK(std::abs(ticks.at(303).held - ticks.at(302).command) < rounding); // commands are not lost
    }
}

TEST_CASE("the share of lost readings and commands is as configured and depends only on the seed") {
    const std::string faults = R"([{"kind": "frames_lost", "share": 0.01, "from_s": 1, "for_s": 10}])";
    const std::vector<Tick> ticks = run(faults, 12);
    REQUIRE(ticks.size() == 12000);
    std::size_t readings = 0, commands = 0;
    for (std::size_t tick = 0; tick + 1 < ticks.size(); ++tick) {
        const bool acts = tick >= 1000 && tick < 11000;
        const bool reading = !ticks[tick].position;
        const bool command = ticks[tick + 1].held != ticks[tick].command;
        CHECK((acts || !(reading || command)));
        readings += reading ? 1 : 0;
        commands += command ? 1 : 0;
    }
    // Binomial distribution: 100 of 10,000 with a standard deviation of 9.95, five of which are allowed.
    CHECK(std::abs(static_cast<double>(readings) - 100) < 50);
    CHECK(std::abs(static_cast<double>(commands) - 100) < 50);
    CHECK(ticks == run(faults, 12));
    const std::vector<Tick> other = run(faults, 2, nullptr, 2);
    const auto lost = [](const Tick& one) { return !one.position; };
    CHECK(std::ranges::find_if(ticks, lost) - ticks.begin() !=
          std::ranges::find_if(other, lost) - other.begin());
}

TEST_CASE("a lossy bus loses the configured share of frames in each direction and silent devices lose all "
          "commands") {
    ScriptedBus wire;
    wire.room = 100'000;
    LossyBus<ScriptedBus> bus(wire, 7);
    LinkFaults faults;
    faults.share_lost = 0.05;
    bus.set_faults(faults);
    std::array<hal::Frame, 10> room{};
    std::size_t received = 0;
    for (std::uint32_t i = 0; i < 20'000; ++i) {
        hal::Frame frame;
        frame.id = i;
        CHECK(bus.send(frame) == hal::SendResult::sent); // the sender does not notice the loss
        wire.waiting.push_back(frame);
        if (wire.waiting.size() == room.size()) {
            const std::span<const hal::Frame> frames = bus.drain(room);
            CHECK(std::ranges::is_sorted(frames, {}, &hal::Frame::id));
            received += frames.size();
        }
    }
    // Binomial distribution: 1,000 of 20,000 with a standard deviation of 30.8, five of which are allowed.
    CHECK(std::abs(static_cast<double>(wire.taken.size()) - 19'000) < 155);
    CHECK(std::abs(static_cast<double>(received) - 19'000) < 155);
    wire.taken.clear();
    faults = {};
    faults.devices_silent = true;
    bus.set_faults(faults);
    wire.waiting.assign(10, {});
    CHECK(bus.send({}) == hal::SendResult::sent);
    CHECK(wire.taken.empty());
    CHECK(bus.drain(room).size() == 10);
}

TEST_CASE("a late tick of the loop sees the arm under the old command and delays its own command") {
    const std::string late = R"([{"kind": "late_ticks", "at_s": 0.3, "late_s": 0.0025}])";
    const BusDescription bus = one_drive(at_set);
    for (const BusDescription* const link : {static_cast<const BusDescription*>(nullptr), &bus}) {
        const std::vector<Tick> ticks = run(late, 0.4, link);
        CHECK(same_until(ticks, run("[]", 0.4, link), 0.3));
        const double count_rad = link == nullptr ? 0 : 2 * 3.1416 / 1048576;
        const auto check_position = [&](const Tick& tick, double measured_s) {
            REQUIRE(tick.position);
            const double there = replayed(ticks, measured_s).truth().position[0];
            CHECK(std::abs(*tick.position - there) < 6e-5 + count_rad); // five times the noise
            CHECK(tick.true_position == replayed(ticks, tick.begun_s).truth().position[0]);
        };
        const Tick& tick = ticks.at(300);
        CHECK(tick.begun_s == Approx(0.3025));
        CHECK(std::abs(tick.held - ticks[299].command) < rounding);
        check_position(tick, 0.302);                  // from the last cycle of the devices before the tick
        for (const std::size_t next : {301U, 302U}) { // made up for at once, without a new reading
            CHECK(ticks[next].begun_s == tick.begun_s);
            CHECK_FALSE(ticks[next].position);
            CHECK(ticks[next].true_position == tick.true_position);
            CHECK(std::abs(ticks[next].held - ticks[next - 1].command) < rounding);
        }
        CHECK(ticks[303].begun_s == Approx(0.303));
        check_position(ticks[303], 0.303);
        CHECK(ticks[303].true_position != tick.true_position);
        // Errors are relative to the reference at the due times.
        CHECK(std::abs(ticks[300].error - ticks[299].error) < 1e-4);
        CHECK(std::abs(ticks[302].error - ticks[301].error) < 1e-4);
    }
}

// `Pace` keeps the time of a run in real time.
TEST_CASE("late ticks of the loop begin and follow each other and miss deadlines as in real time") {
    const std::vector<Tick> ticks = run(R"([{"kind": "late_ticks", "at_s": 0.1, "late_s": 0.0015, "ticks": 3},
                {"kind": "late_ticks", "at_s": 0.2, "late_s": 0.001},
                {"kind": "late_ticks", "at_s": 0.25, "late_s": 0.012}])",
                                        0.3);
    Pace pace(-1'000'000, 1'000'000);
    std::int64_t clock_ns = 0;
    for (std::size_t i = 0; i < ticks.size(); ++i) {
        clock_ns = std::max(clock_ns, pace.due_ns());
        const bool first = i >= 100 && i < 103;
        const std::int64_t late_ns = first ? 1'500'000 : i == 200 ? 1'000'000 : i == 250 ? 12'000'000 : 0;
        clock_ns = std::max(clock_ns, pace.due_ns() + late_ns);
        const bool missed = pace.begin(clock_ns);
        CAPTURE(i);
        CHECK(ticks[i].missed == missed);
        CHECK(ticks[i].begun_s == Approx(1e-9 * static_cast<double>(clock_ns)).epsilon(1e-9));
        pace.end(clock_ns);
    }
    CHECK(pace.counters().missed == 3 + 11);
}

TEST_CASE("drives drop the last command while a tick is later than their command timeout") {
    const BusDescription bus = one_drive(at_sync);
    const std::vector<Tick> ticks =
        run(R"([{"kind": "late_ticks", "at_s": 0.1, "late_s": 0.03}])", 0.12, &bus);
    CHECK(ticks.at(100).begun_s == Approx(0.13));
    CHECK(ticks.at(99).command != 0);
    CHECK(ticks.at(100).held == 0);
}

TEST_CASE("setting a bus clock of its own shifts the stamps of all later samples but not the pace") {
    for (const double by_s : {0.004, 0.5, -0.004, -0.5}) {
        const std::vector<Tick> ticks = run(
            R"([{"kind": "clock_jump", "clock": "bus", "at_s": 0.1, "by_s": )" + std::to_string(by_s) + "}]",
            0.2);
        REQUIRE(ticks.size() == 200);
        for (std::size_t i = 1; i < ticks.size(); ++i) {
            const std::int64_t step_ns = ticks[i].measured_ns - ticks[i - 1].measured_ns;
            CHECK(step_ns == 1'000'000 + (i == 100 ? std::llround(1e9 * by_s) : 0));
            CHECK(ticks[i].begun_s == Approx(ticks[i].due_s));
        }
    }
}

TEST_CASE("if bus and ticks share a clock that is set then samples continue in the time from before") {
    const BusDescription bus = one_drive(at_sync);
    const std::vector<Tick> ticks =
        run(R"([{"kind": "clock_jump", "clock": "bus", "at_s": 0.1, "by_s": 0.004}])", 0.2, &bus);
    CHECK(ticks.back().measured_ns - ticks.at(50).measured_ns == 149'000'000);
}

TEST_CASE("setting the wall clock while frames wait shifts no sample as on SocketCAN") {
    const BusDescription bus = one_drive(at_sync);
    const std::vector<Tick> sound = run("[]", 0.2, &bus);
    for (const double by_s : {0.004, 0.5, 1.0, -0.004, -0.5, -1.0}) {
        CAPTURE(by_s);
        CHECK(run(R"([{"kind": "clock_jump", "at_s": 0.1, "by_s": )" + std::to_string(by_s) + "}]", 0.2,
                  &bus) == sound);
    }
}

TEST_CASE("frames are stamped with the receiver's wall clock and converted to its monotonic clock") {
    MemoryBus sender, receiver;
    MemoryBus::join(sender, receiver);
    std::array<hal::Frame, 8> room{};
    CHECK(receiver.drain(room).empty());
    for (const std::int64_t set_ns : {4'000'000LL, -1'000'000'000LL, 1'000'000'000LL}) {
        const std::int64_t sent_ns = receiver.now_ns() + 2'000'000;
        receiver.set_time(sent_ns);
        sender.set_time(0); // devices do not share the receiver's clock
        sender.send({});
        receiver.set_time(sent_ns + 500'000);
        receiver.set_wall_clock(set_ns);
        const std::span<const hal::Frame> frames = receiver.drain(room);
        REQUIRE(frames.size() == 1);
        CHECK(frames[0].stamp_ns == sent_ns);
    }
}

} // namespace loop_faults_test
