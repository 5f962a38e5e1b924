// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/dfdyn.hpp"
#include "dfdyn/hal/device/icub_strain.hpp"
#include "dfdyn/hal/device/icub_two_joint_board.hpp"
#include "dfdyn/hal/motion/encoder_reading.hpp"
#include "dfdyn/hal/sample_assembly.hpp"
#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/hal/support/frames.hpp"
#include "tests/hal/support/test_bus.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <functional>
#include <vector>

namespace dfdyn::tests {

constexpr std::int64_t us = 1000;
constexpr std::int64_t ms = 1000 * us;

/// Two joints of an iCub's arm and the wrench at its sensor, at 1 kHz.
using WrenchModel =
    Model<double, Joints<2, 6>, DerivativeFreeReduced<6, 3>, RandomFourier<8>, Nonparametric<>>;

inline WrenchModel::Constants wrench_model_constants(std::mt19937_64& engine) {
    WrenchModel::Constants constants{};
    constants.identity = 1;
    constants.gap_ns = 3 * ms / 2;
    constants.period_ns = ms;
    set_input<WrenchModel::Input>(constants.input, {1, 0.3, 0.05});
    std::normal_distribution<double> normal(0, 0.4);
    for (double& frequency : constants.features.frequencies) {
        frequency = normal(engine);
    }
    constants.features.amplitude = 1 / std::sqrt(8.0);
    constants.output_noise_std = {{0.1, 0.1, 0.1, 0.002, 0.002, 0.002}};
    constants.position_limit = {{10, 10}};
    constants.output_limit = {{3000, 3000, 3000, 100, 100, 100}};
    constants.innovation_limit = std::numeric_limits<double>::max();
    set_learner<double>(constants.learner, 1);
    return constants;
}

/// True positions of the arm; its true wrench follows.
inline std::array<double, 2> true_position(double time_s) {
    return {0.3 + 0.6 * std::sin(1.5 * time_s), -0.7 + 0.5 * std::sin(1.1 * time_s + 1)};
}

inline hal::Wrench true_wrench(double time_s) {
    const std::array<double, 2> q = true_position(time_s);
    return {20 * std::sin(q[0]), 20 * std::cos(q[0]), 10 * q[1], 2 * q[0], 2 * std::sin(q[1]), q[0] - q[1]};
}

constexpr hal::Wrench full_scales{1500, 1500, 2000, 35, 35, 25};

/// An arm on a bus, the assembly that reads its frames, and an estimator that learns from the samples. Every
/// tick checks that the samples are true and that only valid samples are learned.
class ArmOnBus {
  public:
    using Board = hal::icub::TwoJointBoard;
    using Sensor = hal::icub::StrainBoard;
    using Assembly = hal::SampleAssembly<double, 2, Board, 1, hal::WrenchOutput<Sensor, 16>>;

    static constexpr std::int64_t start_ns = 100'000 * ms;
    static constexpr int qualification_ticks = 10;
    static constexpr int lags = WrenchModel::Input::lags;

    struct Tick {
        Assembly::Assembled assembled;
        bool predicted = false; ///< by the estimator
        bool learned = false;

        [[nodiscard]] hal::Reason position() const { return assembled.report.position; }
        [[nodiscard]] hal::Reason output() const { return assembled.report.output; }
        [[nodiscard]] bool good() const { return predicted && learned; }
    };

    explicit ArmOnBus(std::mt19937_64& engine, bool full_scales_known = true)
        : engine_(&engine), constants_(wrench_model_constants(engine)), estimator(constants_) {
        if (full_scales_known) {
            answer_full_scales();
        }
    }
    ArmOnBus(const ArmOnBus&) = delete;
    ArmOnBus& operator=(const ArmOnBus&) = delete;

    /// Sends the full scales of the sensor.
    void answer_full_scales() {
        for (int channel = 0; channel < 6; ++channel) {
            const Frame frame =
                simulated_sensor_.encode_full_scale(channel, full_scales[static_cast<std::size_t>(channel)]);
            simulated_sensor_.decode(frame);
            bus.waiting.push_back(at_time(frame, time_ns(number)));
        }
    }

    /// Frames of tick `k`: positions 0.1 ms after its beginning, force and torque 0.2 ms and 0.33 ms after
    /// it.
    std::vector<hal::Frame> frames_of(int k) {
        std::array<hal::JointValue, 2> joints{};
        const std::array<double, 2> q = true_position(hal::seconds_of(time_ns(k) + 100 * us));
        joints[0].position_rad = q[0];
        joints[1].position_rad = q[1];
        hal::Wrench wrench = true_wrench(hal::seconds_of(time_ns(k) + 200 * us));
        std::uniform_real_distribution<double> noise(-2, 2); // steps of the converter
        for (std::size_t i = 0; i < 6; ++i) {
            wrench[i] += noise(*engine_) * full_scales[i] / 32768;
        }
        const hal::FrameList halves = simulated_sensor_.encode(wrench);
        return {at_time(board_.encode(joints).frame[0], time_ns(k) + 100 * us),
                at_time(halves.frame[0], time_ns(k) + 200 * us),
                at_time(halves.frame[1], time_ns(k) + 330 * us)};
    }

    /// Runs the next tick with its frames unchanged.
    Tick tick() {
        return tick([](std::vector<hal::Frame>&) {});
    }

    /// Runs the next tick with its frames changed by `fault`.
    Tick tick(const std::function<void(std::vector<hal::Frame>&)>& fault) {
        std::vector<hal::Frame> frames = frames_of(number);
        fault(frames);
        bus.waiting.insert(bus.waiting.end(), frames.begin(), frames.end());
        ++number;
        return read();
    }

    /// Reads the bus at the end of the tick and learns.
    Tick read() {
        bus.now = time_ns(number);
        assembly.drain(bus, buffer_);
        Tick tick;
        tick.assembled = assembly.assemble(bus.now - delay_ns, bus.now);
        const std::uint64_t learned_before = estimator.counters().learned;
        if (tick.assembled.valid()) {
            tick.predicted = estimator.tick(tick.assembled.sample, Budget::unlimited()).status.predicted();
        }
        tick.learned = estimator.counters().learned > learned_before;
        check(tick);
        return tick;
    }

    /// Runs several ticks. Returns true if all of them predicted and learned.
    bool run(int ticks) {
        bool all = true;
        for (int i = 0; i < ticks; ++i) {
            all = tick().good() && all;
        }
        return all;
    }

    /// Runs ticks until one is good. Returns the number of ticks that were not.
    int ticks_to_recover() {
        int ticks = 0;
        while (ticks < 1000 && !tick().good()) {
            ++ticks;
        }
        return ticks;
    }

    /// Runs until the sources have qualified and the window is full.
    void warm_up() {
        REQUIRE(ticks_to_recover() <= qualification_ticks + lags + 2);
        REQUIRE(run(20));
    }

    static std::int64_t time_ns(int k) { return start_ns + k * ms; }

    static constexpr std::int64_t delay_ns = 1 * ms;
    static constexpr std::int64_t max_age_ns = 2500 * us;

  private:
    using Frame = hal::Frame;

    static Board make_board() { return {1, {0, -11.375, 20}, {1, 11.375, 0}}; }
    static Assembly::Config make_config() {
        return {.board = {make_board()},
                .position = {.max_age_ns = max_age_ns,
                             .latency_ns = 0,
                             .qualification = {qualification_ticks, 1000}},
                .position_range = {{{-3, 3}, {-3, 3}}},
                .clock = {.tolerance_ns = 5 * ms, .max_step_ns = 100 * ms, .adopt_after = 20}};
    }
    static hal::WrenchOutput<Sensor, 16> make_output() {
        return {Sensor(0x0D),
                {.track = {.max_age_ns = max_age_ns,
                           .latency_ns = 0,
                           .qualification = {qualification_ticks, 1000}},
                 .range = {{{-1500, 1500}, {-1500, 1500}, {-2000, 2000}, {-35, 35}, {-35, 35}, {-25, 25}}},
                 .pairing = {.period_ns = ms, .delay_ns = 400 * us},
                 .frozen_limit = frozen_limit}};
    }

    /// Checks that a sample is correct at its time, within the sensors' resolution and the motion during a
    /// hold. Checks that an invalid output is not learned.
    void check(const Tick& tick) const {
        const auto& [sample, report] = tick.assembled;
        if (!tick.assembled.valid()) {
            CHECK_FALSE(sample.output_valid);
            CHECK_FALSE(tick.learned);
            return;
        }
        const std::array<double, 2> q = true_position(hal::seconds_of(sample.time_ns));
        const hal::Wrench wrench = true_wrench(hal::seconds_of(sample.time_ns));
        for (std::size_t i = 0; i < 2; ++i) {
            const double off_s = std::max(0.0, hal::seconds_of(report.position_age_ns[i] - delay_ns)) +
                                 hal::seconds_of(clock_error_ns);
            const double half_tick = 0.5 / 11.375 * std::numbers::pi / 180;
            CHECK(std::abs(sample.position[static_cast<int>(i)] - q[i]) <= 1.01 * half_tick + off_s);
        }
        if (!sample.output_valid) {
            CHECK_FALSE(tick.learned);
            return;
        }
        for (std::size_t i = 0; i < 6; ++i) {
            const double off_s = std::max(0.0, hal::seconds_of(report.output_age_ns - delay_ns)) +
                                 hal::seconds_of(clock_error_ns);
            CHECK(std::abs(sample.output[static_cast<int>(i)] - wrench[i]) <=
                  3 * full_scales[i] / 32768 + 25 * off_s);
        }
    }

    std::mt19937_64* engine_;
    WrenchModel::Constants constants_;
    Board board_ = make_board();
    Sensor simulated_sensor_{0x0D};
    std::array<Frame, 64> buffer_{};

  public:
    static constexpr int frozen_limit = 5;
    TestBus bus;
    Assembly assembly{make_config(), make_output()};
    Estimator<WrenchModel> estimator;
    int number = 0;                  ///< number of the next tick
    std::int64_t clock_error_ns = 0; ///< error of time stamps on an adopted clock
};

/// Indices of the frames of a tick.
constexpr std::size_t joint_frame = 0;
constexpr std::size_t force_frame = 1;
constexpr std::size_t torque_frame = 2;

} // namespace dfdyn::tests
