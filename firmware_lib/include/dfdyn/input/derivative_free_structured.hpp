// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/input/derivative_free_reduced.hpp"

#include <limits>

namespace dfdyn {

/// Gains and poles of input DFSR: velocity α₁ (1 - z⁻¹)/(1 - β₁ z⁻¹) q, acceleration α₂ (1 - z⁻¹)²/(1 - β₂
/// z⁻¹) q. α₁ = 1/T_s and α₂ = 1/T_s² give rad/s and rad/s² up to the filters' gains 1/(1 - β). 0 < β < 1.
template <class Scalar>
struct StructuredFilters {
    Scalar alpha1, alpha2;
    Scalar beta1, beta2;
};

/// Writes the three FIR rows of DFSR (paper, Section V-C), 3 × (M+1), row-major, M ≥ 2.
template <class Scalar>
constexpr void structured_rows(const StructuredFilters<Scalar>& filters, int lags, Scalar* rows) noexcept {
    Scalar* position = rows;
    Scalar* velocity = rows + (lags + 1);
    Scalar* acceleration = rows + 2 * (lags + 1);
    position[0] = 1;
    velocity[0] = filters.alpha1;
    acceleration[0] = filters.alpha2;
    Scalar velocity_tail = filters.alpha1 * (filters.beta1 - 1);
    Scalar acceleration_tail = filters.alpha2 * (filters.beta2 - 1) * (filters.beta2 - 1);
    for (int lag = 1; lag <= lags; ++lag) {
        position[lag] = 0;
        velocity[lag] = velocity_tail;
        velocity_tail *= filters.beta1;
        if (lag == 1) {
            acceleration[lag] = filters.alpha2 * (filters.beta2 - 2);
        } else {
            acceleration[lag] = acceleration_tail;
            acceleration_tail *= filters.beta2;
        }
    }
}

/// Input DFSR as in the paper: FIR rows of length M+1 and three features per joint (position, velocity,
/// acceleration). The rows of the constants come from `structured_rows` and `to_difference_form`.
template <int M>
struct DerivativeFreeStructured : DerivativeFreeReduced<M, 3> {
    static_assert(M == dynamic || M >= 2, "the acceleration row needs at least three positions");
    static constexpr int identity = 4;
};

/// Input DFSR as the recursive filter that the FIR rows truncate. Its memory does not grow with M, and
/// velocity and acceleration at a constant position decay to exactly zero. After M+1 samples it differs from
/// the FIR rows by their truncation error, of order β^M. Initial state: the arm at rest at its first
/// position. Cost: 7 n multiply-adds.
template <int M>
struct DerivativeFreeStructuredRecursive {
    static_assert(M == dynamic || M >= 2);
    static constexpr int identity = 5;
    static constexpr int lags = M;
    static constexpr int features_per_joint = 3;
    template <class Scalar, int n, int m>
    using Sample = dfdyn::Sample<Scalar, n, m>;

    template <class Scalar, int n>
    struct Constants {
        StructuredFilters<Scalar> filters;
        Storage<Scalar, product(n, 3)> scale; ///< per element of ξ
    };

    template <class Scalar, int n>
    class Map {
      public:
        using Constants = DerivativeFreeStructuredRecursive::Constants<Scalar, n>;

        constexpr Map(const Constants& constants, Extent<n> joints, Extent<M> lag_count,
                      Extent<3> /*rows*/) noexcept
            : constants_(&constants), joints_(joints), lags_(lag_count), position_(zeros(joints)),
              step_(zeros(joints)), velocity_(zeros(joints)), acceleration_(zeros(joints)) {}

        constexpr void restart() noexcept { seen_ = 0; }
        [[nodiscard]] constexpr bool ready() const noexcept { return seen_ == lags_ + 1; }

        template <class AnySample>
        constexpr void push(const AnySample& sample) noexcept {
            for (int i = 0; i < joints_; ++i) {
                if (seen_ == 0) {
                    position_[i] = sample.position[i];
                    step_[i] = velocity_[i] = acceleration_[i] = 0;
                }
                advance(i, sample.position[i]);
            }
            seen_ = ready() ? seen_ : seen_ + 1;
        }

        constexpr void evaluate(Scalar* xi) const noexcept {
            for (int i = 0; i < joints_; ++i) {
                xi[3 * i] = constants_->scale[3 * i] * position_[i];
                xi[3 * i + 1] = constants_->scale[3 * i + 1] * velocity_[i];
                xi[3 * i + 2] = constants_->scale[3 * i + 2] * acceleration_[i];
            }
        }

        [[nodiscard]] static constexpr std::int64_t cost(int joints, int /*lags*/, int /*rows*/) noexcept {
            return std::int64_t{joints} * 7;
        }

        [[nodiscard]] static constexpr std::int64_t state_bytes(int joints, int /*lags*/,
                                                                int /*rows*/) noexcept {
            return 4 * storage_bytes<Scalar>(joints);
        }

        /// Of `push` and `evaluate`.
        [[nodiscard]] static constexpr std::int64_t stack_bytes() noexcept { return frame_bytes; }

      private:
        using Joints = Storage<Scalar, n>;
        static constexpr Joints zeros(Extent<n> joints) noexcept { return Joints::zeros(joints); }

        /// Flushes small values to zero: a decaying filter would end in denormals, which cost some machines a
        /// hundred times as much.
        static constexpr Scalar without_denormals(Scalar value) noexcept {
            constexpr Scalar floor =
                std::numeric_limits<Scalar>::min() / std::numeric_limits<Scalar>::epsilon();
            return value < floor && value > -floor ? Scalar(0) : value;
        }

        constexpr void advance(int i, Scalar position) noexcept {
            const StructuredFilters<Scalar>& filters = constants_->filters;
            const Scalar step = position - position_[i];
            velocity_[i] = without_denormals(filters.beta1 * velocity_[i] + filters.alpha1 * step);
            acceleration_[i] =
                without_denormals(filters.beta2 * acceleration_[i] + filters.alpha2 * (step - step_[i]));
            position_[i] = position;
            step_[i] = step;
        }

        const Constants* constants_;
        [[no_unique_address]] Extent<n> joints_;
        [[no_unique_address]] Extent<M> lags_;
        Joints position_, step_, velocity_, acceleration_;
        int seen_ = 0;
    };
};

} // namespace dfdyn
