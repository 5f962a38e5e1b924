// SPDX-License-Identifier: Apache-2.0
// Time stamps that jump while the clock of the bus continues.
#include "dfdyn/hal/assembly/sampler.hpp"
#include "dfdyn/hal/bus_event.hpp"
#include "tests/hal/support/arm_on_bus.hpp"

namespace hal = dfdyn::hal;
using namespace dfdyn::tests;
using hal::Reason;

namespace {

using Frames = std::vector<hal::Frame>;

auto shifted_by(std::int64_t jump_ns) {
    return [jump_ns](Frames& frames) {
        for (hal::Frame& frame : frames) {
            frame.stamp_ns += jump_ns;
        }
    };
}

/// The arm in the form that a sampler takes, with a timer.
struct SampledArm {
    ArmOnBus::Assembly& assembly;

    std::optional<std::int64_t> take(const hal::Frame& frame, std::int64_t now_ns) {
        assembly.take(frame, now_ns);
        return std::nullopt;
    }
    void update(hal::BusState state, const hal::BusCounters& counters) { assembly.update(state, counters); }
    bool pending(std::int64_t instant_ns, std::int64_t now_ns) const {
        return assembly.pending(instant_ns, now_ns);
    }
    auto assemble(std::int64_t instant_ns, std::int64_t now_ns) {
        return assembly.assemble(instant_ns, now_ns);
    }
};

/// Samples an arm by the stamps of its frames, and counts the valid samples.
class StampedBench {
  public:
    explicit StampedBench(std::mt19937_64& engine) : arm_(engine), sampled_{arm_.assembly} {}

    /// Sends the first `count` frames of the next tick with stamps that are off by `by_ns`.
    void send(std::int64_t by_ns, std::size_t count = 3) {
        std::vector<hal::Frame> frames = arm_.frames_of(arm_.number++);
        frames.resize(count);
        for (hal::Frame& frame : frames) {
            frame.stamp_ns += by_ns;
            frame.stamp_source = hal::StampSource::hardware;
            take(frame);
        }
    }
    /// An error frame, or one of this program, that the operating system has stamped.
    void send_by_host_clock(std::int64_t by_ns, bool error) {
        hal::Frame frame = frame_of(error ? 0x4 : 0x7F0, {0, 0, 0, 0, 0, 0, 0, 0}, 0);
        frame.error = error;
        frame.origin = error ? hal::Origin::remote : hal::Origin::this_socket;
        frame.stamp_source = hal::StampSource::kernel;
        frame.stamp_ns = ArmOnBus::time_ns(arm_.number) + by_ns;
        take(frame);
    }
    void send_bus_off(std::int64_t by_ns) {
        hal::Frame frame;
        frame.error = true;
        frame.id = 0x40;
        frame.length = 8;
        frame.stamp_source = hal::StampSource::hardware;
        frame.stamp_ns = ArmOnBus::time_ns(arm_.number) + by_ns;
        take(frame);
    }
    void be_silent(int ticks) { arm_.number += ticks; }

    int valid = 0; ///< samples
    [[nodiscard]] std::uint64_t adopted() const { return arm_.assembly.bus().clock.adopted(); }

  private:
    void take(const hal::Frame& frame) {
        hal::note_frame(frame, state_, counters_);
        sampler_.take(sampled_, frame, state_, counters_,
                      [&](const auto& sample, std::int64_t) { valid += sample.valid() ? 1 : 0; });
    }

    ArmOnBus arm_;
    SampledArm sampled_;
    hal::Sampler<SampledArm> sampler_{
        {.timer = true, .period_ns = ms, .delay_ns = 3 * ms / 2, .patience_ns = 3 * ms}};
    hal::BusState state_ = hal::BusState::active;
    hal::BusCounters counters_;
};

} // namespace

TEST_CASE("fault 20: frames with an outlier as time stamp are rejected") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    for (const std::int64_t jump : {-6000 * ms, 6000 * ms, -100'000 * ms}) {
        const auto stray = arm.tick(shifted_by(jump));
        CHECK(stray.predicted); // the last positions are held
        CHECK_FALSE(stray.learned);
        CHECK(arm.ticks_to_recover() <= 2);
        CHECK(arm.run(10));
    }
    CHECK(arm.assembly.bus().clock.refused() == 9);
    CHECK(arm.assembly.bus().clock.adopted() == 0);
}

TEST_CASE("faults 22 and 23: a clock that was set is rejected at first and then adopted and counted") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const std::int64_t jump : {-6000 * ms, 6000 * ms}) {
        ArmOnBus arm(engine);
        arm.warm_up();
        // the new clock is known only to within the age of the frame that decided on it
        arm.clock_error_ns = ms;
        int doubtful = 0;
        for (int tick = 0; tick < 300; ++tick) { // twenty times as many readings as usual qualify
            doubtful += arm.tick(shifted_by(jump)).position() == Reason::clock_jumped ? 1 : 0;
        }
        CHECK(doubtful >= 2); // between the held positions and the adoption of the clock
        CHECK(arm.assembly.bus().clock.adopted() == 1);
        CHECK(arm.assembly.bus().clock.refused() == 20);
        CHECK(arm.tick(shifted_by(jump)).good());
    }
}

TEST_CASE("fault 22: no second sample is assembled for the same time") {
    DFDYN_SEEDED_ENGINE(engine);
    ArmOnBus arm(engine);
    arm.warm_up();
    const auto again = arm.read(); // the caller's timer expired twice
    CHECK(again.position() == Reason::time_not_increasing);
    CHECK(arm.run(10));
}

TEST_CASE("faults 22, 25 and 23: samples continue after a bus-off with clock steps back and forward") {
    DFDYN_SEEDED_ENGINE(engine);
    for (std::size_t before = 17; before <= 20; ++before) { // frames by the new clock
        StampedBench bench(engine);
        for (int tick = 0; tick < 100; ++tick) {
            bench.send(0);
        }
        for (std::size_t left = before; left > 0; left -= std::min<std::size_t>(left, 3)) {
            bench.send(-342 * ms, std::min<std::size_t>(left, 3));
        }
        bench.send_bus_off(-342 * ms);
        bench.be_silent(360);
        for (int tick = 0; tick < 300; ++tick) { // twenty times as many readings as usual qualify
            bench.send(27 * ms);
        }
        const int valid_before = bench.valid;
        for (int tick = 0; tick < 100; ++tick) {
            bench.send(27 * ms);
        }
        CAPTURE(before);
        CHECK(bench.valid >= valid_before + 99);
    }
}

TEST_CASE("error frames and own frames with stamps of another clock do not set the devices' clock") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const bool error : {true, false}) {
        for (const std::int64_t by_ns : {-3000 * ms, -20 * ms, 20 * ms, 3000 * ms}) {
            CAPTURE(error, by_ns);
            StampedBench bench(engine);
            for (int tick = 0; tick < 100; ++tick) {
                bench.send(0);
            }
            for (int frame = 0; frame < 60; ++frame) {
                bench.send_by_host_clock(by_ns, error);
            }
            const int valid_before = bench.valid;
            for (int tick = 0; tick < 100; ++tick) {
                bench.send(0);
                bench.send_by_host_clock(by_ns, error);
            }
            CHECK(bench.adopted() == 0);
            CHECK(bench.valid >= valid_before + 99);
        }
    }
}
