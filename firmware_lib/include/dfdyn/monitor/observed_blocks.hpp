// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/input/derivative_free_reduced.hpp"
#include "dfdyn/monitor/block_noise.hpp"
#include "dfdyn/monitor/output_block.hpp"
#include "dfdyn/monitor/tool_columns.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace dfdyn {

/// Input of a monitor for one tick. Arrays of n or m values.
template <class Scalar>
struct Observation {
    std::int64_t time_ns;             ///< stamp of the sample
    const Scalar* position;           ///< rad, m
    const Scalar* output;             ///< measured, output units
    const Scalar* prediction;         ///< one-step-ahead prediction of the estimator
    const Scalar* standard_deviation; ///< of the output around that prediction
    const Scalar* held_prediction;    ///< with delayed weights (`DelayedWeights`)
};

/// Geometry, time scales and the false-alarm rate of a monitor. The constants must outlive the monitor.
template <class Scalar, class Arm, int M>
struct MonitorConstants {
    static_assert(M == dynamic || (M >= 2 && M % 2 == 0), "the window has a sample in its middle");
    static constexpr int n = Arm::joints;       ///< joints
    static constexpr int m = Arm::outputs;      ///< outputs
    using Motion = DerivativeFreeReduced<M, 3>; ///< position, velocity and acceleration from the window

    [[no_unique_address]] typename Arm::Sizes sizes;       ///< numbers of joints, outputs and bodies
    [[no_unique_address]] Extent<M> lags;                  ///< of the window of positions, even
    typename Arm::template Constants<Scalar> chain;        ///< geometry of the arm
    typename Motion::template Constants<Scalar, n> motion; ///< `centred_motion_rows` in difference form
    Storage<Scalar, m> output_gain;     ///< output per N·m or N: 1, or 1 / torque constant (A/N·m)
    Scalar tip[3];                      ///< m, point of a force on the tool, in the last link's frame
    Scalar sign_velocity;               ///< rad/s, v of the sign of friction tanh(q̇ / v)
    SpeedClasses<Scalar> speed;         ///< upper bounds of "stationary" and "creeping"
    std::int32_t block_samples;         ///< about 0.1 s
    Scalar blocks_between_false_alarms; ///< mean distance, all outputs together
    std::int32_t report_blocks;         ///< from the onset to the first report, about 2 s
    std::int32_t longest_blocks;        ///< largest duration of a change, about 20 s
    std::int32_t refresh_blocks;        ///< refresh period of the delayed weights, about 3 s
};

/// Means of an observation over blocks of about 0.1 s, with the last `history` of them in a ring.
template <class Scalar, class Arm, int M, int history>
class ObservedBlocks {
  public:
    static constexpr int n = Arm::joints;               ///< joints
    static constexpr int m = Arm::outputs;              ///< outputs
    using Constants = MonitorConstants<Scalar, Arm, M>; ///< of the monitor
    using Motion = typename Constants::Motion;          ///< of the joints, from the window
    using Block = OutputBlock<Scalar>;                  ///< means of one output
    /// Joint torques, which joint friction changes, and no wrench.
    static constexpr bool torques = std::is_same_v<typename Arm::Output, JointTorques>;

    /// Bound of innovations and residuals, in predicted deviations. A clamped spike cannot overflow a square
    /// or dominate a mean over later blocks. A persistent deviation of this size still raises an alarm.
    static constexpr Scalar largest_deviation = 1000;
    static constexpr Scalar largest_position = 10'000; ///< rad, m; a larger position counts as a gap

    explicit ObservedBlocks(const Constants&&) = delete; // it would refer to a temporary
    /// Starts without a block. Refers to `constants`.
    explicit ObservedBlocks(const Constants& constants) noexcept
        : constants_(&constants), motion_(constants.motion, constants.sizes.joint_count, constants.lags, {}),
          innovations_(constants.sizes.output_count, constants.lags),
          residuals_(constants.sizes.output_count, constants.lags),
          screws_(Storage<Screw<Scalar>, m>::zeros(constants.sizes.output_count)),
          xi_(Inputs::zeros(extent<product(3, n)>(3 * joints()))),
          payload_(Storage<Scalar, product(payload_columns, m)>::zeros(
              extent<product(payload_columns, m)>(payload_columns * outputs()))),
          force_(Storage<Scalar, product(force_columns, m)>::zeros(
              extent<product(force_columns, m)>(force_columns * outputs()))),
          scaled_(Outputs::zeros(constants.sizes.output_count)), deviations_(scaled_),
          block_(Storage<Block, m>::zeros(constants.sizes.output_count)),
          past_(Past::zeros(extent<product(history, m)>(history * outputs()))) {}

    /// Returns whether all values are finite, the positions possible and the deviations positive.
    [[nodiscard]] bool usable(const Observation<Scalar>& observation) const noexcept {
        bool all = true;
        for (int i = 0; i < joints(); ++i) {
            all = all && std::abs(observation.position[i]) <= largest_position; // NaN is not
        }
        for (int k = 0; k < outputs(); ++k) {
            all = all && std::isfinite(observation.output[k]) && std::isfinite(observation.prediction[k]) &&
                  std::isfinite(observation.held_prediction[k]) && observation.standard_deviation[k] > 0 &&
                  std::isfinite(observation.standard_deviation[k]);
        }
        return all;
    }

    /// Adds a usable observation. Returns true if it completes a block: `newest()` is its number.
    bool add(const Observation<Scalar>& observation) noexcept {
        push(observation);
        if (!motion_.ready() || !residuals_.full()) {
            return false;
        }
        motion_.evaluate(xi_.data());
        if (samples_ == constants_->block_samples / 2) {
            take_tool_columns();
        }
        accumulate();
        if (++samples_ < constants_->block_samples) {
            return false;
        }
        store(observation.time_ns);
        return true;
    }

    /// Restarts the windows and the current block after a gap. The ring stays.
    void interrupt() noexcept {
        motion_.restart();
        innovations_.restart();
        residuals_.restart();
        clear();
        follows_ = false;
    }

    /// Returns the number of the newest block, from 1; 0: none yet.
    [[nodiscard]] std::int64_t newest() const noexcept { return newest_; }
    /// Returns how many blocks up to the newest follow each other without a gap, at most `history`.
    [[nodiscard]] int unbroken() const noexcept { return unbroken_; }
    /// Returns the m means of a block among the last `history`: newest() - history < number ≤ newest().
    [[nodiscard]] const Block* block(std::int64_t number) const noexcept {
        return past_.data() + slot(number) * outputs();
    }
    /// Returns the stamp of a block's last sample.
    [[nodiscard]] std::int64_t end_ns(std::int64_t number) const noexcept { return ends_ns_[slot(number)]; }

    /// Returns the largest cost of `add`, in multiply-adds.
    [[nodiscard]] static constexpr std::int64_t cost(const typename Arm::Sizes& sizes, int lags) noexcept {
        return Motion::template Map<Scalar, n>::cost(sizes.joint_count, lags, 3) +
               tool_columns_cost(sizes.joint_count, sizes.output_count) +
               std::int64_t{sizes.output_count} * (function_cost + 30);
    }

  private:
    using Inputs = Storage<Scalar, product(3, n)>;
    using Outputs = Storage<Scalar, m>;
    using Past = Storage<Block, product(history, m)>;

    /// Adapts a plain array to the interface of the window of positions.
    struct Positions {
        const Scalar* values;
        [[nodiscard]] const Scalar* data() const noexcept { return values; }
    };
    struct Pose {
        Positions position;
    };

    [[nodiscard]] int joints() const noexcept { return constants_->sizes.joint_count; }
    [[nodiscard]] int outputs() const noexcept { return constants_->sizes.output_count; }

    [[nodiscard]] static Scalar bounded(Scalar value, Scalar deviation) noexcept {
        return std::clamp(value, -largest_deviation * deviation, largest_deviation * deviation);
    }

    void push(const Observation<Scalar>& observation) noexcept {
        motion_.push(Pose{{observation.position}});
        for (int k = 0; k < outputs(); ++k) {
            deviations_[k] = observation.standard_deviation[k];
            scaled_[k] = bounded((observation.output[k] - observation.prediction[k]) / deviations_[k], 1);
        }
        innovations_.push(scaled_.data());
        for (int k = 0; k < outputs(); ++k) {
            scaled_[k] = bounded(observation.output[k] - observation.held_prediction[k], deviations_[k]);
        }
        residuals_.push(scaled_.data());
    }

    /// Evaluates the columns of payload and force in the middle of the block.
    void take_tool_columns() noexcept {
        tool_columns<Arm, Scalar>(constants_->chain, constants_->sizes, xi_.data(), constants_->tip,
                                  screws_.data(), payload_.data(), force_.data());
        for (int k = 0; k < outputs(); ++k) {
            const Scalar gain = constants_->output_gain[k];
            for (int i = 0; i < payload_columns; ++i) {
                block_[k].payload[i] = gain * payload_[payload_columns * k + i];
            }
            for (int i = 0; i < force_columns; ++i) {
                block_[k].force[i] = gain * force_[force_columns * k + i];
            }
        }
    }

    void accumulate() noexcept {
        const int middle = constants_->lags / 2;
        const Scalar share = 1 / static_cast<Scalar>(constants_->block_samples);
        for (int k = 0; k < outputs(); ++k) {
            Block& sum = block_[k];
            sum.innovation += share * innovations_.row(middle)[k];
            sum.deviation += share * deviations_[k];
            sum.residual += share * residuals_.row(middle)[k];
            if constexpr (torques) {
                const Scalar velocity = xi_[3 * k + 1];
                using std::abs;
                using std::tanh;
                const Scalar gain = share * constants_->output_gain[k];
                sum.speed += share * abs(velocity);
                sum.friction[0] += gain * tanh(velocity / constants_->sign_velocity);
                sum.friction[1] += gain * velocity;
            }
        }
    }

    void store(std::int64_t time_ns) noexcept {
        ++newest_;
        std::copy_n(block_.data(), outputs(), past_.data() + slot(newest_) * outputs());
        ends_ns_[slot(newest_)] = time_ns;
        unbroken_ = follows_ ? std::min(unbroken_ + 1, history) : 1;
        follows_ = true;
        clear();
    }

    void clear() noexcept {
        samples_ = 0;
        for (int k = 0; k < outputs(); ++k) {
            block_[k] = {};
        }
    }

    /// Returns the index of a block in the ring.
    [[nodiscard]] static int slot(std::int64_t number) noexcept { return static_cast<int>(number % history); }

    const Constants* constants_;
    typename Motion::template Map<Scalar, n> motion_;
    LagWindow<Scalar, m, M> innovations_, residuals_;
    Storage<Screw<Scalar>, m> screws_; ///< workspace
    Inputs xi_;
    Storage<Scalar, product(payload_columns, m)> payload_;
    Storage<Scalar, product(force_columns, m)> force_;
    Outputs scaled_, deviations_;
    Storage<Block, m> block_;                  ///< current block
    Past past_;                                ///< ring of the last blocks
    Storage<std::int64_t, history> ends_ns_{}; ///< their end times
    int samples_ = 0;                          ///< in the current block
    std::int64_t newest_ = 0;
    int unbroken_ = 0;
    bool follows_ = false; ///< the current block follows the newest one without a gap
};

} // namespace dfdyn
