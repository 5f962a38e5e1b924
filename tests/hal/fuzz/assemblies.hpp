// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/ati_netcan.hpp"
#include "dfdyn/hal/device/cia402.hpp"
#include "dfdyn/hal/device/icub_2foc.hpp"
#include "dfdyn/hal/device/icub_strain.hpp"
#include "dfdyn/hal/device/icub_two_joint_board.hpp"
#include "dfdyn/hal/device/odrive.hpp"
#include "dfdyn/hal/device/robotous_rft.hpp"
#include "dfdyn/hal/sample_assembly.hpp"

#include <vector>

namespace dfdyn::tests {

constexpr std::int64_t fuzz_ms = 1'000'000;
constexpr hal::TrackConfig fuzz_track{
    .max_age_ns = 20 * fuzz_ms, .latency_ns = 100'000, .qualification = {.readings = 2, .zero_readings = 5}};
constexpr hal::Range fuzz_joint_range{-3, 3};
constexpr hal::Range fuzz_effort_range{-20, 20};
constexpr hal::RangeGate<6>::Ranges fuzz_wrench_range{
    {{-150, 150}, {-150, 150}, {-200, 200}, {-3.5, 3.5}, {-3.5, 3.5}, {-2.5, 2.5}}};

template <hal::WrenchSource Sensor>
hal::WrenchOutput<Sensor, 8> fuzz_wrench(const Sensor& sensor) {
    return {sensor,
            {.track = fuzz_track,
             .range = fuzz_wrench_range,
             .pairing = {.period_ns = 4 * fuzz_ms, .delay_ns = 2 * fuzz_ms},
             .frozen_limit = 3}};
}

template <int n>
hal::EffortOutput<n, 8> fuzz_efforts() {
    typename hal::EffortOutput<n, 8>::Config config{.track = fuzz_track, .range = {}};
    config.range.fill(fuzz_effort_range);
    return hal::EffortOutput<n, 8>(config);
}

template <class Board, std::size_t boards, class Output>
auto fuzz_assembly(const std::array<Board, boards>& board, const Output& output) {
    using Assembly = hal::SampleAssembly<double, 2, Board, static_cast<int>(boards), Output, 8>;
    return Assembly({.board = board,
                     .position = fuzz_track,
                     .position_range = {fuzz_joint_range, fuzz_joint_range},
                     .clock = {.tolerance_ns = 5 * fuzz_ms, .max_step_ns = 50 * fuzz_ms, .adopt_after = 3},
                     .output_bus = 0},
                    output);
}

/// An arm of every kind of device, listening to the same frames.
class EveryArm {
  public:
    /// Whether all samples assembled so far were within the ranges of their sensors and later than the one
    /// before.
    bool take(const hal::Frame& frame, std::int64_t now_ns) {
        take(icub_, frame, now_ns);
        take(foc_, frame, now_ns);
        take(canopen_, frame, now_ns);
        take(odrive_, frame, now_ns);
        return sound_;
    }

    /// Samples, and how many had a valid output.
    [[nodiscard]] std::uint64_t samples() const { return samples_; }
    [[nodiscard]] std::uint64_t outputs() const { return outputs_; }

    /// Frames that the devices would send for some values.
    [[nodiscard]] std::vector<hal::Frame> good_frames(double size) const {
        std::vector<hal::Frame> frames;
        std::array<hal::JointValue, 2> two{};
        two[0].position_rad = size;
        two[1].position_rad = -size;
        std::array<hal::JointValue, 1> one{};
        one[0].position_rad = size;
        one[0].effort = size;
        const hal::Wrench wrench{40 * size, 10, 60 * size, size, size, size};
        hal::icub::StrainBoard strain(0x0D);
        for (int channel = 0; channel < 6; ++channel) {
            frames.push_back(strain.encode_full_scale(channel, channel < 3 ? 300 : 10));
            strain.decode(frames.back());
        }
        for (const auto& list :
             {mc4_.encode(two), strain.encode(wrench), foc_boards_[0].encode(one), foc_boards_[1].encode(one),
              drives_[0].encode(one), drives_[1].encode(one), axes_[0].encode(one), axes_[1].encode(one),
              robotous_.encode(wrench), ati_.encode(wrench)}) {
            frames.insert(frames.end(), list.frame.begin(), list.frame.begin() + list.count);
        }
        for (const hal::Frame& frame :
             {hal::Cia402Drive::encode_sync(),
              drives_[0].encode_heartbeat(hal::Cia402Drive::State::operational), drives_[1].encode_emcy(0),
              axes_[0].encode_heartbeat(false), axes_[1].encode_heartbeat(false), mc4_.encode_status(0, 0),
              foc_boards_[0].encode_status(0, 0)}) {
            frames.push_back(frame);
        }
        return frames;
    }

  private:
    using Drive = hal::Cia402Drive;

    static hal::AtiNetcan::Config ati_config() {
        hal::AtiNetcan::Config config;
        for (std::size_t i = 0; i < 6; ++i) {
            config.matrix[i][i] = 1;
            config.matrix[i][(i + 1) % 6] = 0.25;
        }
        config.counts_per_newton = 100;
        config.counts_per_newton_metre = 5000;
        return config;
    }
    static Drive::Config drive_config(int joint) {
        return {.node = joint + 1, .joint = joint, .effort_pdo = 0x380};
    }

    template <class Assembly>
    void take(Assembly& assembly, const hal::Frame& frame, std::int64_t now_ns) {
        const auto moment = assembly.take(frame, now_ns);
        using Kind = decltype(moment.kind);
        check(assembly.assemble(moment.kind == Kind::none ? now_ns - fuzz_ms : moment.instant_ns, now_ns));
    }

    template <class Assembled>
    void check(const Assembled& assembled) {
        if (!assembled.valid()) {
            sound_ = sound_ && !assembled.sample.output_valid;
            return;
        }
        ++samples_;
        for (const double position : assembled.sample.position) {
            sound_ = sound_ && position >= fuzz_joint_range.lowest && position <= fuzz_joint_range.highest;
        }
        if (!assembled.sample.output_valid) {
            return;
        }
        ++outputs_;
        for (int k = 0; k < assembled.sample.output.size(); ++k) {
            const hal::Range range = assembled.sample.output.size() == 6
                                         ? fuzz_wrench_range[static_cast<std::size_t>(k)]
                                         : fuzz_effort_range;
            const double value = assembled.sample.output[k];
            sound_ = sound_ && value >= range.lowest && value <= range.highest;
        }
    }

    hal::icub::TwoJointBoard mc4_{1, {0, -11.375, 5}, {1, 11.375, 0}};
    std::array<hal::icub::FocBoard, 2> foc_boards_{hal::icub::FocBoard({.address = 3, .joint = 0}),
                                                   hal::icub::FocBoard({.address = 4, .joint = 1})};
    std::array<Drive, 2> drives_{Drive(drive_config(0)), Drive(drive_config(1))};
    std::array<hal::OdriveAxis, 2> axes_{hal::OdriveAxis({.node = 1, .joint = 0}),
                                         hal::OdriveAxis({.node = 2, .joint = 1})};
    hal::RobotousRft robotous_{hal::RobotousRft::Config{}};
    hal::AtiNetcan ati_{ati_config()};

    decltype(fuzz_assembly(std::array{mc4_}, fuzz_wrench(hal::icub::StrainBoard(0x0D)))) icub_ =
        fuzz_assembly(std::array{mc4_}, fuzz_wrench(hal::icub::StrainBoard(0x0D)));
    decltype(fuzz_assembly(foc_boards_, fuzz_wrench(robotous_))) foc_ =
        fuzz_assembly(foc_boards_, fuzz_wrench(robotous_));
    decltype(fuzz_assembly(drives_, fuzz_efforts<2>())) canopen_ = fuzz_assembly(drives_, fuzz_efforts<2>());
    decltype(fuzz_assembly(axes_, fuzz_wrench(ati_))) odrive_ = fuzz_assembly(axes_, fuzz_wrench(ati_));
    bool sound_ = true;
    std::uint64_t samples_ = 0;
    std::uint64_t outputs_ = 0;
};

} // namespace dfdyn::tests
