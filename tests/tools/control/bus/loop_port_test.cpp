// SPDX-License-Identifier: Apache-2.0
#include "tools/control/bus/loop_port.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/control/bus/scripted_bus.hpp"
#include "tests/tools/control/pendulum.hpp"
#include "tools/can/arm/device_frames.hpp"

#include <string>
#include <vector>

namespace loop_port_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;
namespace hal = dfdyn::hal;

constexpr std::int64_t period = 1'000'000;

hal::Frame stamped(hal::Frame frame, std::int64_t time_ns) {
    frame.stamp_ns = time_ns;
    return frame;
}

/// A port and the drive at the other end of the bus, run tick by tick.
class Line {
  public:
    explicit Line(const BusDescription& description) : devices_(description), port_(description, 0.001) {}

    /// Advances by one period. If `sends` is set, the drive sends position and torque, stamped `jump_ns`
    /// ahead.
    LoopInput tick(double position, bool sends = true) {
        bus.time_ns += period;
        if (sends) {
            send(position);
        }
        port_.receive(bus, bus.time_ns);
        return port_.sense(bus.time_ns);
    }
    LoopPort& port() { return port_; }

    ScriptedBus bus;
    std::int64_t jump_ns = 0; ///< offset of the clock that stamps

  private:
    void send(double position) {
        if (const auto frame = devices_.sync()) {
            bus.waiting.push_back(stamped(*frame, bus.time_ns + jump_ns));
        }
        const double torque = 10 * position;
        for (const hal::Frame& frame : devices_.joints({&position, 1}, {&torque, 1})) {
            bus.waiting.push_back(stamped(frame, bus.time_ns + jump_ns));
        }
    }

    DeviceFrames devices_;
    LoopPort port_;
};

/// Position (rad) at a tick.
double at(int tick) { return 0.5 + 0.001 * tick; }

TEST_CASE("a tick gets position and torque of the time that the description's trigger defines") {
    const auto [trigger, delay] =
        GENERATE(table<std::string, int>({{at_sync, 1}, {at_timer, 2}, {at_set, 0}}));
    CAPTURE(trigger);
    Line line(one_drive(trigger));
    CHECK(line.port().delay_ticks() == delay);
    LoopInput input;
    for (int tick = 0; tick < 30; ++tick) {
        input = line.tick(at(tick));
    }
    REQUIRE(input.position != nullptr);
    REQUIRE(input.torque != nullptr);
    CHECK(input.time_ns == line.bus.time_ns - delay * period);
    CHECK((*input.position)[0] == Approx(at(29 - delay)).margin(1e-5));
    CHECK((*input.torque)[0] == Approx(10 * at(29 - delay)).margin(1e-3));
}

TEST_CASE("on a bus without measured torque the commanded torque is used") {
    Line line(one_drive(at_set, "i"));
    for (int tick = 0; tick < 30; ++tick) {
        line.tick(at(tick));
    }
    CHECK(line.tick(at(30)).torque == nullptr); // nothing was commanded yet
    line.port().send(line.bus, JointVector::Constant(1, 7));
    CHECK((*line.tick(at(31)).torque)[0] == 7);
}

TEST_CASE("the commanded torque belongs to the time of the delayed position") {
    Line line(one_drive(at_timer, "i"));
    REQUIRE(line.port().delay_ticks() == 2);
    LoopInput input;
    for (int tick = 0; tick < 40; ++tick) {
        input = line.tick(at(tick));
        if (tick >= 30) {
            REQUIRE(input.torque != nullptr);
            CHECK((*input.torque)[0] ==
                  tick - 3); // sent a tick before the measurement, which is two ticks old
        }
        line.port().send(line.bus, JointVector::Constant(1, tick));
    }
}

TEST_CASE("devices that measure at any time within a tick get the commanded torque") {
    Line line(one_drive(at_set, "i"));
    line.jump_ns = -7 * period / 10;
    for (int tick = 0; tick < 40; ++tick) {
        const LoopInput input = line.tick(at(tick));
        if (tick >= 30) {
            REQUIRE(input.position != nullptr);
            REQUIRE(input.torque != nullptr);
            CHECK((*input.torque)[0] == tick - 1);
        }
        line.port().send(line.bus, JointVector::Constant(1, tick));
    }
}

TEST_CASE("a silent drive or an impossible position gives ticks without position and the reason") {
    Line line(one_drive(at_timer));
    for (int tick = 0; tick < 30; ++tick) {
        line.tick(at(tick));
    }
    LoopInput input;
    for (int tick = 0; tick < 20; ++tick) {
        input = line.tick(0, false);
    }
    CHECK(input.position == nullptr);
    CHECK(line.port().counters().last_reason == hal::Reason::position_stale);
    CHECK(line.port().counters().last_joint == 0);
    const std::uint64_t invalid = line.port().counters().invalid;
    for (int tick = 0; tick < 5; ++tick) {
        input = line.tick(100); // 100 rad is 16 turns away
    }
    CHECK(input.position == nullptr);
    CHECK(line.port().counters().last_reason == hal::Reason::position_out_of_range);
    CHECK(line.port().counters().invalid == invalid + 5);
}

TEST_CASE("a sample of an earlier cycle keeps its own stamp") {
    Line line(one_drive(at_sync));
    for (int tick = 0; tick < 30; ++tick) {
        line.tick(at(tick));
    }
    CHECK(line.tick(0, false).position == nullptr);
    const LoopInput late = line.tick(at(31));
    REQUIRE(late.position != nullptr);
    CHECK((*late.position)[0] == Approx(at(29)).margin(1e-5));
    CHECK(late.time_ns == line.bus.time_ns - 2 * period);
    const LoopInput next = line.tick(at(32));
    CHECK(next.time_ns == line.bus.time_ns - period);
}

TEST_CASE("a joint whose value is held from the previous sample is reported as missing") {
    std::string trigger = at_timer;
    Line line(one_drive(trigger.replace(trigger.find("0.002"), 5, "0.000")));
    for (int tick = 0; tick < 30; ++tick) {
        CHECK(line.tick(at(tick)).missing == nullptr);
    }
    const LoopInput input = line.tick(0, false);
    REQUIRE(input.position != nullptr);
    REQUIRE(input.missing != nullptr);
    CHECK((*input.missing)[0]);
    CHECK(line.port().counters().held == 1);
    CHECK(line.tick(at(31)).missing == nullptr);
}

TEST_CASE("devices that qualify again are reported as returning and silent devices are not") {
    Line line(one_drive(at_sync));
    for (int tick = 0; tick < 30; ++tick) {
        line.tick(at(tick));
    }
    for (int tick = 0; tick < 6; ++tick) {
        CHECK_FALSE(line.tick(0, false).returning);
    }
    CHECK(line.tick(at(36)).position != nullptr); // belongs to the SYNC before the silence
    int returning = 0;
    for (int tick = 37; line.tick(at(tick)).position == nullptr; ++tick) {
        ++returning;
        REQUIRE(returning < 20);
    }
    CHECK(returning >= 9);
    CHECK(line.port().counters().last_reason == hal::Reason::qualifying);
}

TEST_CASE("after a small jump of the bus clock samples are on the clock of the ticks again") {
    const std::string trigger = GENERATE(at_sync, at_set, at_timer);
    CAPTURE(trigger);
    Line line(one_drive(trigger));
    int tick = 0;
    for (; tick < 50; ++tick) {
        line.tick(at(tick));
    }
    line.jump_ns = -4 * period;
    const int delay = line.port().delay_ticks();
    int without = 0;
    for (int after = 0; after < 30; ++after, ++tick) {
        const LoopInput input = line.tick(at(tick));
        if (input.position == nullptr || input.missing != nullptr) {
            ++without;
            continue;
        }
        CHECK(input.time_ns == line.bus.time_ns - delay * period);
        CHECK((*input.position)[0] == Approx(at(tick - delay)).margin(1e-5));
    }
    CHECK(without <= 8);
    CHECK(line.port().counters().clock_jumps == 1);
}

TEST_CASE("setting the common clock of ticks and stamps leaves the times of the measurements unchanged") {
    const std::string trigger = GENERATE(at_sync, at_set, at_timer);
    const int periods = GENERATE(-4, -2, -1, 1, 2);
    CAPTURE(trigger, periods);
    Line line(one_drive(trigger));
    int tick = 0;
    for (; tick < 50; ++tick) {
        line.tick(at(tick));
    }
    line.bus.time_ns += periods * period;
    int used = 0;
    for (int after = 0; after < 30; ++after, ++tick) {
        const LoopInput input = line.tick(at(tick));
        if (input.position != nullptr && input.missing == nullptr) {
            ++used;
            const std::int64_t measured = tick + 1 - line.port().delay_ticks(); // tick 0 was after one period
            CHECK(input.time_ns == measured * period);
            CHECK((*input.position)[0] == Approx(at(tick - line.port().delay_ticks())).margin(1e-5));
        }
    }
    CHECK(used > 20);
    CHECK(line.port().counters().clock_jumps == 1);
}

TEST_CASE("ticks without a complete sample are counted") {
    Line line(one_drive(at_set));
    for (int tick = 0; tick < 30; ++tick) {
        line.tick(at(tick));
    }
    const PortCounters before = line.port().counters();
    CHECK(line.tick(0, false).position == nullptr);
    CHECK(line.port().counters().incomplete == before.incomplete + 1);
    CHECK(line.port().counters().invalid == before.invalid);
}

TEST_CASE("a flood is read in pieces of bounded size and the sample behind it is found") {
    Line line(one_drive(at_set));
    for (int tick = 0; tick < 30; ++tick) {
        line.tick(at(tick));
    }
    CHECK(line.port().counters().most_in_tick <= 3);
    line.bus.waiting.assign(2 * LoopPort::frames_per_tick + 10, stamped(hal::Frame{}, line.bus.time_ns));
    int ticks = 1;
    while (line.tick(at(30), ticks == 1).position == nullptr) {
        REQUIRE(++ticks < 5);
    }
    CHECK(ticks == 3);
    CHECK(line.port().counters().most_in_tick == LoopPort::frames_per_tick);
    CHECK(line.port().counters().overfull_ticks == 2);
}

TEST_CASE("only a bus that is off or an interface that is down counts as lost") {
    Line line(one_drive(at_set));
    for (const auto& [state, lost] :
         {std::pair(hal::BusState::active, false), std::pair(hal::BusState::warning, false),
          std::pair(hal::BusState::passive, false), std::pair(hal::BusState::off, true),
          std::pair(hal::BusState::interface_down, true)}) {
        line.bus.bus_state = state;
        CHECK(line.tick(0.5).bus_lost == lost);
    }
}

TEST_CASE("command frames that do not fit on the bus are counted") {
    Line line(one_drive(at_set));
    line.bus.room = 1;
    line.port().send(line.bus, JointVector::Constant(1, 1));
    CHECK(line.port().counters().refused == 0);
    line.port().send(line.bus, JointVector::Constant(1, 1));
    CHECK(line.port().counters().refused == 1);
}

TEST_CASE("a sensor that has not sent its full scales is requested to do so ten times a second") {
    const TemporaryDirectory directory;
    std::string text = file_content(DFDYN_TEST_DATA_DIR "/can/icub_loop.json");
    const std::string known = R"(, "full_scale": [1500, 1500, 2000, 35, 35, 25])";
    text.erase(text.find(known), known.size());
    const BusDescription description = read_bus_description(directory.write("bus.json", text));
    LoopPort port(description, 0.001);
    ScriptedBus bus;
    for (int tick = 0; tick < 200; ++tick) {
        port.receive(bus, bus.time_ns);
        bus.time_ns += period;
    }
    REQUIRE(bus.taken.size() == 12);
    CHECK(bus.taken[0].id == 0x20D);
    const DeviceFrames devices(read_bus_description(DFDYN_TEST_DATA_DIR "/can/icub_loop.json"));
    for (std::size_t channel = 0; channel < 6; ++channel) {
        bus.waiting.push_back(stamped(*devices.answer(bus.taken[channel]), bus.time_ns));
    }
    for (int tick = 0; tick < 200; ++tick) {
        port.receive(bus, bus.time_ns);
        bus.time_ns += period;
    }
    CHECK(bus.taken.size() == 12);
}

} // namespace loop_port_test
