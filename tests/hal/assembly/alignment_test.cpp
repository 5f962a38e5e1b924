// SPDX-License-Identifier: Apache-2.0
// Values at one time from devices with different phases, rates and latencies.
#include "dfdyn/hal/device/icub_2foc.hpp"
#include "dfdyn/hal/device/odrive.hpp"
#include "dfdyn/hal/device/robotous_rft.hpp"
#include "dfdyn/hal/motion/encoder_reading.hpp"
#include "dfdyn/hal/sample_assembly.hpp"

#include "tests/hal/support/frames.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <vector>

namespace alignment_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;

constexpr std::int64_t us = 1000;
constexpr std::int64_t ms = 1000 * us;

using Arm = SampleAssembly<float, 2, OdriveAxis, 2, WrenchOutput<RobotousRft, 16>>;

double angle(double time_s) { return std::sin(3 * time_s); }
double force(double time_s) { return 100 * angle(time_s); } // steep, so that a wrong time shows
double difference(float a, double b) { return std::abs(static_cast<double>(a) - b); }

constexpr StartupGate::Config at_once{.readings = 1, .zero_readings = 1};
constexpr std::int64_t force_latency_ns = 1200 * us;

Arm make_arm() {
    const Range wide{-1000, 1000};
    const Arm::Config config{.board = {OdriveAxis({.node = 1, .joint = 0, .heartbeat_timeout_ns = 0}),
                                       OdriveAxis({.node = 2, .joint = 1, .heartbeat_timeout_ns = 0})},
                             .position = {.max_age_ns = 3 * ms, .latency_ns = 0, .qualification = at_once},
                             .position_range = {Range{-3, 3}, Range{-3, 3}},
                             .clock = {}};
    return {config,
            {RobotousRft({.first_id = 0xF9, .second_id = 0xFA}),
             {.track = {.max_age_ns = 3 * ms, .latency_ns = force_latency_ns, .qualification = at_once},
              .range = {wide, wide, wide, wide, wide, wide},
              .pairing = {.period_ns = ms, .delay_ns = 400 * us},
              .frozen_limit = 50}}}; // these forces have no noise, and are constant at their peaks
}

/// Returns the frames of the devices from 0 to `end_ns`, by stamp: joint 1 every 1 ms, joint 2 every 0.97 ms
/// with jitter, the force every 1.03 ms, stamped after its latency.
std::vector<Frame> traffic(std::int64_t end_ns, std::mt19937_64& engine) {
    std::vector<Frame> frames;
    std::array<OdriveAxis, 2> axes{OdriveAxis({.node = 1}), OdriveAxis({.node = 2})};
    const RobotousRft sensor({.first_id = 0xF9, .second_id = 0xFA});
    std::uniform_int_distribution<std::int64_t> jitter(0, 100 * us);
    for (std::size_t joint = 0; joint < 2; ++joint) {
        const std::int64_t period = joint == 0 ? 1000 * us : 970 * us;
        for (std::int64_t time = 130 * us; time < end_ns; time += period) {
            const std::int64_t stamp = time + jitter(engine);
            std::array<JointValue, 1> value{};
            value[0].position_rad = angle(seconds_of(stamp));
            frames.push_back(at_time(axes[joint].encode(value).frame[0], stamp));
        }
    }
    for (std::int64_t time = 0; time < end_ns; time += 1030 * us) {
        const double fx = force(seconds_of(time));
        const FrameList halves = sensor.encode({fx, fx / 2, -fx, 0.1, 0.2, 0.3});
        frames.push_back(at_time(halves.frame[0], time + force_latency_ns));
        frames.push_back(at_time(halves.frame[1], time + force_latency_ns + 130 * us));
    }
    std::ranges::stable_sort(frames, {}, &Frame::stamp_ns);
    return frames;
}

TEST_CASE("a timer's samples are periodic and correct for any phases, rates and latencies") {
    DFDYN_SEEDED_ENGINE(engine);
    Arm arm = make_arm();
    const std::vector<Frame> frames = traffic(1000 * ms, engine);
    std::size_t next = 0;
    int outputs = 0;
    for (std::int64_t now = 10 * ms; now < 1000 * ms; now += ms) {
        for (; next < frames.size() && frames[next].stamp_ns <= now; ++next) {
            arm.take(frames[next], now);
        }
        const std::int64_t instant = now - force_latency_ns - 1300 * us;
        const auto [sample, report] = arm.assemble(instant, now);
        REQUIRE(report.position == Reason::ok);
        REQUIRE(sample.time_ns == instant);
        // Interpolation over 1 ms at 3 rad/s and 9 rad/s² has an error of a few µrad; for the force add a
        // step.
        REQUIRE(difference(sample.position[0], angle(seconds_of(instant))) < 3e-6);
        REQUIRE(difference(sample.position[1], angle(seconds_of(instant))) < 3e-6);
        if (sample.output_valid) {
            ++outputs;
            REQUIRE(difference(sample.output[0], force(seconds_of(instant))) < 0.011);
        } else {
            REQUIRE(report.output == Reason::output_not_new); // the sensor is a little slower than the timer
        }
    }
    CHECK(outputs > 950);
    CHECK(outputs < 970); // 990 ms / 1.03 ms
}

TEST_CASE("without frames there are no samples and no valid outputs") {
    Arm arm = make_arm();
    const auto [sample, report] = arm.assemble(0, 0);
    CHECK(report.position == Reason::waiting_for_position);
    CHECK(report.joint == 0);
    CHECK(report.output == Reason::waiting_for_output);
    CHECK(report.position_age_ns[0] == std::numeric_limits<std::int64_t>::max());
    CHECK_FALSE(sample.output_valid);
}

TEST_CASE("an arm whose joints measure their currents has one output per joint") {
    using CurrentArm = SampleAssembly<double, 2, icub::FocBoard, 2, EffortOutput<2, 8>>;
    const std::array<icub::FocBoard, 2> boards{icub::FocBoard({.address = 1, .joint = 1}),
                                               icub::FocBoard({.address = 2, .joint = 0})};
    const TrackConfig track{.max_age_ns = 3 * ms, .latency_ns = 0, .qualification = at_once};
    CurrentArm arm({.board = boards,
                    .position = track,
                    .position_range = {Range{-3, 3}, Range{-3, 3}},
                    .clock = {},
                    .limits = {MotionLimits{500, 1e6}, MotionLimits{500, 1e6}}},
                   EffortOutput<2, 8>({.track = track, .range = {Range{-10, 10}, Range{-5, 5}}}));
    const auto send = [&](std::size_t board, double position_rad, double current_A, std::int64_t stamp) {
        std::array<JointValue, 1> value{};
        value[0].position_rad = position_rad;
        value[0].effort = current_A;
        return arm.take(at_time(boards[board].encode(value).frame[0], stamp), stamp);
    };
    using Kind = dfdyn::hal::SampleTrigger::Kind;
    CHECK(send(0, 0.5, 2, ms).kind == Kind::none);
    const auto set = send(1, -0.5, -3, ms + 100 * us);
    CHECK(set.kind == Kind::set);
    CHECK(set.instant_ns == ms);
    send(0, 0.7, 4, 2 * ms);
    send(1, -0.7, -5, 2 * ms + 100 * us);
    const auto [sample, report] = arm.assemble(2 * ms, 3 * ms);
    CHECK(report.position == Reason::ok);
    REQUIRE(sample.output_valid);
    CHECK(sample.position[0] == Approx(-0.68).margin(1e-4)); // 90 % of the interval
    CHECK(sample.position[1] == Approx(0.7).margin(1e-4));
    CHECK(sample.output[0] == Approx(-4.8).margin(1e-9));
    CHECK(sample.output[1] == Approx(4).margin(1e-9));
    // Both currents are beyond their range, so that the output is not valid.
    send(0, 0.9, 5.5, 3 * ms);
    send(1, -0.9, -5, 3 * ms + 100 * us);
    CHECK(arm.assemble(3 * ms, 4 * ms).report.output == Reason::output_out_of_range);
    for (int cycle = 4; cycle < 6; ++cycle) { // both neighbours of the next sample time
        const double position_rad = 0.2 * cycle + 0.3;
        send(0, position_rad, 4, cycle * ms);
        send(1, -position_rad, cycle == 4 ? -5 : -11, cycle * ms + 100 * us);
    }
    CHECK(arm.assemble(5 * ms, 6 * ms).report.output == Reason::output_out_of_range);
    CHECK_FALSE(arm.colliding_id().has_value());
}

} // namespace alignment_test
