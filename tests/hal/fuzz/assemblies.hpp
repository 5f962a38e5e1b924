// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/sample_assembly.hpp"
#include "every_family.hpp"

#include <tuple>
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
                     .clock = {.tolerance_ns = 5 * fuzz_ms, .max_step_ns = 50 * fuzz_ms, .adopt_after = 3}},
                    output);
}

/// An arm of one family: boards with their efforts, or a sensor.
template <class Family>
auto fuzz_arm() {
    if constexpr (JointFamily<Family>) {
        return fuzz_assembly(boards_of<Family>(), fuzz_efforts<2>());
    } else {
        return fuzz_assembly(boards_of<Family>(), fuzz_wrench(Family::sensor()));
    }
}

/// Frames that the devices of a family send for some values, and their other frames.
template <class Family>
void add_good_frames(double size, std::vector<hal::Frame>& frames) {
    const auto add = [&](const hal::FrameList& list) {
        frames.insert(frames.end(), list.frame.begin(), list.frame.begin() + list.count);
    };
    const auto others = Family::other_frames();
    frames.insert(frames.end(), others.begin(), others.end());
    if constexpr (JointFamily<Family>) {
        for (const auto& board : Family::boards()) {
            std::array<hal::JointValue, std::remove_cvref_t<decltype(board)>::joints> values{};
            for (std::size_t i = 0; i < values.size(); ++i) {
                values[i].position_rad = i == 0 ? size : -size;
                values[i].effort = size;
            }
            add(board.encode(values));
        }
    } else {
        auto sensor = Family::sensor();
        for (const hal::Frame& frame : others) {
            static_cast<void>(sensor.decode(frame)); // full scales
        }
        add(sensor.encode({40 * size, 10, 60 * size, size, size, size}));
    }
}

/// One arm of every family; all receive the same frames.
template <class... Family>
class ArmsOf {
  public:
    /// Returns true if all samples assembled so far were within the ranges of their sensors and in increasing
    /// order of time.
    bool take(const hal::Frame& frame, std::int64_t now_ns) {
        std::apply([&](auto&... arm) { (take(arm, frame, now_ns), ...); }, arms_);
        return sound_;
    }

    /// Number of samples, and number of those with a valid output.
    [[nodiscard]] std::uint64_t samples() const { return samples_; }
    [[nodiscard]] std::uint64_t outputs() const { return outputs_; }

    /// Frames that the devices would send for some values.
    [[nodiscard]] std::vector<hal::Frame> good_frames(double size) const {
        std::vector<hal::Frame> frames;
        (add_good_frames<Family>(size, frames), ...);
        return frames;
    }

  private:
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

    std::tuple<decltype(fuzz_arm<Family>())...> arms_{fuzz_arm<Family>()...};
    bool sound_ = true;
    std::uint64_t samples_ = 0;
    std::uint64_t outputs_ = 0;
};

using EveryArm = EveryFamily<ArmsOf>;

} // namespace dfdyn::tests
