// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/bus_watch.hpp"
#include "dfdyn/hal/assembly/effort_output.hpp"
#include "dfdyn/hal/assembly/joint_tracks.hpp"
#include "dfdyn/hal/assembly/sample_report.hpp"
#include "dfdyn/hal/assembly/sample_trigger.hpp"
#include "dfdyn/hal/assembly/wrench_output.hpp"
#include "dfdyn/hal/bus.hpp"
#include "dfdyn/sample.hpp"

#include <limits>
#include <optional>
#include <span>

namespace dfdyn::hal {

/// Assembles samples from the frames of a bus: all joints and the outputs at one time.
///
/// `take` (or `drain`, for all frames of a bus) accepts the frames as they arrive. `assemble(instant, now)`
/// returns the sample of an instant in the recent past. Each value is interpolated linearly between the
/// measurements before and after the instant, or held if the next measurement is not due yet. A value that
/// was due and did not arrive is missing: there is no sample until the next value arrives (`pending`, Track).
/// Positions must agree with the joint's motion (MotionGate). If the instants have a constant period, the
/// samples have it too, independently of the devices' phases and jitter. An instant is chosen
/// - by SYNC: `SampleTrigger::sync`; its instant is the SYNC at which the complete values were measured;
/// - by a timer: `now - delay`. With a delay of the output's latency and one period of the slowest source all
///   values are interpolated; with a shorter delay predictions are more recent, and values are held;
/// - by the last frame of a set: `SampleTrigger::set`; its instant is the time of the output's measurement.
/// The latency from the measurement to the frame is subtracted from each stamp first. An output is valid in
/// at most one sample for each of its measurements.
///
/// If a position is bad, there is no sample; the report lists the joints that have a position. If an output
/// is bad, the sample has `output_valid = false`.
///
/// If `n` is `dynamic`, the configuration contains the number of joints. `Board` is the JointSource of each
/// of `boards` boards; `Output` is a WrenchOutput or EffortOutput. Cost of `take`: O(boards + n); of
/// `assemble`: O(capacity (n + outputs)).
template <class Scalar, int n, JointSource Board, int boards, class Output, int capacity = 16>
class SampleAssembly {
  public:
    using Assembled = AssembledSample<Scalar, n, Output::outputs>; ///< sample and report
    using Sample = decltype(Assembled::sample);                    ///< for `Estimator::tick`
    using Report = decltype(Assembled::report);                    ///< validity of the sample's values

    /// Boards, clocks and limits of an arm.
    struct Config {
        std::array<Board, static_cast<std::size_t>(boards)> board; ///< joints they name must be < n
        TrackConfig position;               ///< period, latency and age of the positions
        PerJoint<Range, n> position_range;  ///< rad
        ClockGate::Config clock;            ///< of the frames' time stamps
        PerJoint<MotionLimits, n> limits{}; ///< largest velocity and acceleration
        Extent<n> joints{};                 ///< at most `largest_joint_count`
    };

    /// Starts without measurements. `colliding_id` finds mistakes in the configuration.
    // A small stack has no room for a copy: NOLINTNEXTLINE(modernize-pass-by-value)
    constexpr SampleAssembly(const Config& config, const Output& output) noexcept
        : joints_(config.joints), board_(config.board),
          position_(config.joints, config.position, config.position_range, config.limits), output_(output),
          watch_(config.clock), moments_(config.joints) {}

    /// Accepts a frame, read at `now_ns`. Returns the instant that it completes, if any.
    constexpr SampleTrigger take(const Frame& frame, std::int64_t now_ns) noexcept {
        const std::uint64_t clocks = watch_.clock.adopted();
        const auto stamp_ns = watch_.witness.shows_clock(frame) ? watch_.clock.accept(frame.stamp_ns, now_ns)
                                                                : std::optional<std::int64_t>();
        if (watch_.clock.adopted() != clocks) {
            position_.clock_set();
        }
        if (frame.error) {
            return {}; // the bus has counted it and has it in its state
        }
        if (frame.origin == Origin::this_socket) {
            ++watch_.own;
            return {};
        }
        watch_.from_host += frame.origin == Origin::this_host ? 1U : 0U;
        if (!stamp_ns) {
            return {};
        }
        Frame timed = frame;
        timed.stamp_ns = *stamp_ns;
        return offer(timed);
    }

    /// Accepts all frames of a bus, in at most `rounds` drains, and its state. Calls `on_moment` for each
    /// instant that a frame completes.
    template <Bus B, class OnMoment>
    constexpr void drain(B& bus, std::span<Frame> buffer, OnMoment on_moment) noexcept {
        for (int round = 0; round < rounds; ++round) {
            const std::span<const Frame> frames = bus.drain(buffer);
            update(bus.state(), bus.counters());
            for (const Frame& frame : frames) {
                if (const SampleTrigger moment = take(frame, bus.now_ns());
                    moment.kind != SampleTrigger::Kind::none) {
                    on_moment(moment);
                }
            }
            if (frames.size() < buffer.size()) {
                return;
            }
        }
    }
    /// Accepts all frames of a bus and its state.
    template <Bus B>
    constexpr void drain(B& bus, std::span<Frame> buffer) noexcept {
        drain(bus, buffer, [](const SampleTrigger& /*moment*/) {});
    }

    /// Accepts the state and the counters of a bus after a drain. `drain` calls it.
    constexpr void update(BusState state, const BusCounters& counters) noexcept {
        const std::uint64_t before = watch_.health.losses();
        watch_.health.update(state, counters);
        if (watch_.health.losses() != before) {
            output_.lost();
        }
    }

    /// Drops a set that is not complete at `now_ns`. The next set contains later measurements only. Returns
    /// true if the dropped set contained a joint.
    constexpr bool drop_set(std::int64_t now_ns) noexcept { return moments_.drop_set(now_ns); }

    /// Returns true if a value of this instant is missing that the next frames may supply. It becomes false
    /// at the latest `max_age` of the sources and one period after the last value.
    [[nodiscard]] constexpr bool pending(std::int64_t instant_ns, std::int64_t now_ns) const noexcept {
        return output_.pending(instant_ns, now_ns) || position_.pending(instant_ns, now_ns);
    }

    /// Returns the sample of an instant not later than `now_ns`, both on the clock of the bus. Missing
    /// positions are 0; outputs are 0 without `output_valid`.
    constexpr Assembled assemble(std::int64_t instant_ns, std::int64_t now_ns) noexcept {
        Assembled result{};
        result.report.joints = joints_;
        result.report.outputs = output_.size();
        result.sample.time_ns = instant_ns;
        fill_ages(result.report, now_ns);
        result.report.position = fill_positions(result.sample, result.report, now_ns);
        const bool loss = watch_.health.take_loss();
        if (result.valid()) {
            last_instant_ns_ = instant_ns;
            result.report.output = fill_output(result.sample, loss, now_ns);
        } else {
            result.report.output = output_condition(output_.at(instant_ns, now_ns), loss);
        }
        result.sample.output_valid = result.valid() && result.report.output == Reason::ok;
        result.report.output_origin =
            result.sample.output_valid ? output_.origin(instant_ns) : ValueOrigin::none;
        counters_.add(result);
        return result;
    }

    /// Returns a standard identifier that two devices would send; none if there is no such mistake.
    /// O(2048 (boards + 1)): call it once at the start.
    [[nodiscard]] constexpr std::optional<std::uint32_t> colliding_id() const noexcept {
        for (std::uint32_t id = 0; id <= 0x7FF; ++id) {
            int senders = output_.claims(id) ? 1 : 0;
            for (const Board& board : board_) {
                senders += board.claims(id) ? 1 : 0;
            }
            if (senders > 1) {
                return id;
            }
        }
        return std::nullopt;
    }

    /// Returns the numbers of samples and of refusals by reason.
    [[nodiscard]] constexpr const AssemblyCounters& counters() const noexcept { return counters_; }
    /// Returns clock and health of the bus.
    [[nodiscard]] constexpr const BusWatch& bus() const noexcept { return watch_; }
    /// Returns the measurements of a joint, `joint` from 0.
    [[nodiscard]] constexpr const PositionTrack<capacity>& position(int joint) const noexcept {
        return position_[static_cast<std::size_t>(joint)];
    }
    /// Returns the measurements of the outputs.
    [[nodiscard]] constexpr const Output& output() const noexcept { return output_; }

  private:
    static constexpr int rounds = 8;
    static constexpr int output_places = places(Output::outputs);
    static constexpr std::int64_t never_ns = std::numeric_limits<std::int64_t>::max();

    [[nodiscard]] constexpr std::size_t used() const noexcept { return static_cast<std::size_t>(joints_); }

    /// Passes a frame to the boards and the sensor.
    constexpr SampleTrigger offer(const Frame& frame) noexcept {
        bool known = false;
        SampleTrigger moment;
        for (Board& board : board_) {
            const Decoded decoded = board.decode(frame);
            known = known || decoded.kind != Decoded::Kind::nothing || concerns(board, frame);
            moment = take_decoded(decoded, frame, moment);
        }
        const Decoded decoded = output_.take(frame);
        if (decoded.kind == Decoded::Kind::part && decoded.part == 0) {
            position_.sensor_measured(frame.stamp_ns, output_.period_ns());
        }
        known = known || decoded.kind != Decoded::Kind::nothing || concerns(output_, frame);
        moment = take_decoded(decoded, frame, moment);
        if (!known) {
            watch_.unknown.add(frame, Reason::ok);
        }
        return moment.kind == SampleTrigger::Kind::none && output_.heard()
                   ? moments_.completed(output_.newest_ns())
                   : moment;
    }

    constexpr SampleTrigger take_decoded(const Decoded& decoded, const Frame& frame,
                                         const SampleTrigger& moment) noexcept {
        switch (decoded.kind) {
        case Decoded::Kind::values:
            for (int i = 0; i < decoded.joints; ++i) {
                take_joint(decoded.joint[static_cast<std::size_t>(i)]);
            }
            break;
        case Decoded::Kind::rejected:
            watch_.rejected.add(frame, decoded.reason);
            break;
        case Decoded::Kind::lost:
            watch_.health.device_lost();
            break;
        case Decoded::Kind::sync:
            return moment.kind == SampleTrigger::Kind::none ? moments_.synchronised(frame.stamp_ns) : moment;
        case Decoded::Kind::nothing:
        case Decoded::Kind::part:
        case Decoded::Kind::status:
            break;
        }
        return moment;
    }

    constexpr void take_joint(const JointValue& value) noexcept {
        if (value.joint < 0 || value.joint >= joints_) {
            return;
        }
        const auto joint = static_cast<std::size_t>(value.joint);
        JointValue judged = value;
        if (value.position_reason != Reason::waiting_for_position) {
            const Reason reason = position_.push(value);
            if (reason != Reason::time_not_increasing) { // the frame is not a repeated or overtaken one
                moments_.measured(joint);
            }
            const bool other_source = reason == Reason::position_jump || reason == Reason::position_lost ||
                                      reason == Reason::position_frozen || reason == Reason::id_collision ||
                                      reason == Reason::velocity_contradicts;
            if (other_source && judged.effort_reason == Reason::ok) {
                judged.effort_reason = reason; // of the same frame
            }
        }
        output_.take(judged, position_[joint].motion().position_rad());
    }

    constexpr void fill_ages(Report& report, std::int64_t now_ns) const noexcept {
        for (std::size_t i = 0; i < used(); ++i) {
            report.position_age_ns[i] = position_[i].heard() ? now_ns - position_[i].newest_ns() : never_ns;
        }
        report.output_age_ns = output_.heard() ? now_ns - output_.newest_ns() : never_ns;
    }

    constexpr Reason fill_positions(Sample& sample, Report& report, std::int64_t now_ns) noexcept {
        if (const Reason down = watch_.health.reason(); down != Reason::ok) {
            report.joint_reason.fill(down);
            return down;
        }
        Reason first = Reason::ok;
        for (std::size_t i = 0; i < used(); ++i) {
            const Measurement<1> measured = position_[i].at(sample.time_ns, now_ns);
            report.joint_reason[i] = watch_.explain(measured.reason);
            if (measured.reason == Reason::ok) {
                sample.position[static_cast<int>(i)] = static_cast<Scalar>(measured.value[0]);
                report.position_origin[i] = position_[i].origin(sample.time_ns);
            } else if (first == Reason::ok) {
                first = report.joint_reason[i];
                report.joint = static_cast<int>(i);
            }
        }
        if (first != Reason::ok) {
            return first;
        }
        return sample.time_ns > last_instant_ns_ ? Reason::ok : Reason::time_not_increasing;
    }

    constexpr Reason fill_output(Sample& sample, bool loss, std::int64_t now_ns) noexcept {
        const Measurement<output_places> measured = output_.at(sample.time_ns, now_ns);
        const Reason reason = output_condition(measured, loss);
        if (reason != Reason::ok) {
            return reason;
        }
        last_output_ns_ = measured.stamp_ns;
        for (int k = 0; k < output_places; ++k) {
            sample.output[k] = static_cast<Scalar>(measured.value[static_cast<std::size_t>(k)]);
        }
        return Reason::ok;
    }

    constexpr Reason output_condition(const Measurement<output_places>& measured, bool loss) const noexcept {
        if (const Reason down = watch_.health.reason(); down != Reason::ok) {
            return down;
        }
        if (measured.reason != Reason::ok) {
            return watch_.explain(measured.reason);
        }
        if (loss) {
            return Reason::frames_lost;
        }
        return measured.stamp_ns > last_output_ns_ ? Reason::ok : Reason::output_not_new;
    }

    [[no_unique_address]] Extent<n> joints_;
    std::array<Board, static_cast<std::size_t>(boards)> board_;
    JointTracks<n, capacity> position_;
    Output output_;
    BusWatch watch_;
    SampleTriggerWatch<n> moments_;

    std::int64_t last_instant_ns_ = std::numeric_limits<std::int64_t>::min();
    std::int64_t last_output_ns_ = std::numeric_limits<std::int64_t>::min();
    AssemblyCounters counters_;
};

} // namespace dfdyn::hal
