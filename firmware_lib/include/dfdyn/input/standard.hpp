// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/core/lag_window.hpp"
#include "dfdyn/input/adaptive_window.hpp"
#include "dfdyn/sample.hpp"

namespace dfdyn {

/// Input STD with derivatives estimated from the positions: ξ_i = (q_i, q̇_i, q̈_i) (paper, eq. 1), by the
/// adaptive window over at most M+1 positions. Causal. Bounded cost O(n M²); the maximum is reached at
/// standstill.
template <int M>
struct Standard {
    static_assert(M == dynamic || M >= 2, "an acceleration needs at least three positions");
    static constexpr int identity = 6;
    static constexpr int lags = M;
    static constexpr int features_per_joint = 3;
    template <class Scalar, int n, int m>
    using Sample = dfdyn::Sample<Scalar, n, m>;

    template <class Scalar, int n>
    struct Constants {
        Scalar position_noise_bound; ///< largest error of a measured position (rad), e.g. one encoder count
        Storage<Scalar, product(n, 3)> scale; ///< per element of ξ: relevance / standard deviation
    };

    template <class Scalar, int n>
    class Map {
      public:
        using Constants = Standard::Constants<Scalar, n>;

        constexpr Map(const Constants& constants, Extent<n> joints, Extent<M> lag_count,
                      Extent<3> /*rows*/) noexcept
            : constants_(&constants), joints_(joints), window_(joints, lag_count),
              times_(Extent<1>{}, lag_count), ages_s_(Ages::zeros(extent<sum(M, 1)>(lag_count + 1))) {}

        constexpr void restart() noexcept {
            window_.restart();
            times_.restart();
        }

        [[nodiscard]] constexpr bool ready() const noexcept { return window_.full(); }

        template <class AnySample>
        constexpr void push(const AnySample& sample) noexcept {
            window_.push(sample.position.data());
            times_.push(&sample.time_ns);
            for (int lag = 0; lag < times_.filled(); ++lag) {
                const auto age_ns =
                    // The origin of the clock is arbitrary, so the difference may overflow a signed integer.
                    static_cast<std::uint64_t>(sample.time_ns) - static_cast<std::uint64_t>(*times_.row(lag));
                ages_s_[lag] = static_cast<Scalar>(age_ns) * Scalar(-1e-9);
            }
        }

        constexpr void evaluate(Scalar* xi) const noexcept {
            for (int i = 0; i < joints_; ++i) {
                const AdaptiveWindow<Scalar> derivatives(ages_s_.data(), window_.row(0) + i, joints_,
                                                         window_.filled(), constants_->position_noise_bound);
                xi[3 * i] = constants_->scale[3 * i] * window_.row(0)[i];
                xi[3 * i + 1] = constants_->scale[3 * i + 1] * derivatives.velocity();
                xi[3 * i + 2] = constants_->scale[3 * i + 2] * derivatives.acceleration();
            }
        }

        [[nodiscard]] static constexpr std::int64_t cost(int joints, int lag_count, int /*rows*/) noexcept {
            const int count = lag_count + 1;
            return joints * (AdaptiveWindow<Scalar>::cost(count) + 3) + count;
        }

        [[nodiscard]] static constexpr std::int64_t state_bytes(int joints, int lag_count,
                                                                int /*rows*/) noexcept {
            return LagWindow<Scalar, n, M>::state_bytes(joints, lag_count) +
                   LagWindow<std::int64_t, 1, M>::state_bytes(1, lag_count) +
                   storage_bytes<Scalar>(lag_count + 1);
        }

        /// Returns the maximum stack bytes of `push` and `evaluate`, which compare two polynomials.
        [[nodiscard]] static constexpr std::int64_t stack_bytes() noexcept {
            return frame_bytes + 2 * AdaptiveWindow<Scalar>::fit_bytes;
        }

      private:
        using Ages = Storage<Scalar, sum(M, 1)>;

        const Constants* constants_;
        [[no_unique_address]] Extent<n> joints_;
        LagWindow<Scalar, n, M> window_;
        LagWindow<std::int64_t, 1, M> times_;
        Ages ages_s_; ///< time of each row minus the newest
    };
};

/// Input STD with measured derivatives: the sample contains q̇ and q̈. Cost of `evaluate`: O(n).
struct StandardMeasured {
    static constexpr int identity = 7;
    static constexpr int lags = 0;
    static constexpr int features_per_joint = 3;
    template <class Scalar, int n, int m>
    using Sample = SampleWithDerivatives<Scalar, n, m>;

    template <class Scalar, int n>
    struct Constants {
        Storage<Scalar, product(n, 3)> scale; ///< per element of ξ: relevance / standard deviation
    };

    template <class Scalar, int n>
    class Map {
      public:
        using Constants = StandardMeasured::Constants<Scalar, n>;

        constexpr Map(const Constants& constants, Extent<n> joints, Extent<0> /*lags*/,
                      Extent<3> /*rows*/) noexcept
            : constants_(&constants), joints_(joints),
              state_(State::zeros(extent<product(n, 3)>(3 * joints))) {}

        constexpr void restart() noexcept { ready_ = 0; }
        [[nodiscard]] constexpr bool ready() const noexcept { return ready_ != 0; }

        template <class AnySample>
        constexpr void push(const AnySample& sample) noexcept {
            for (int i = 0; i < joints_; ++i) {
                state_[3 * i] = sample.position[i];
                state_[3 * i + 1] = sample.velocity[i];
                state_[3 * i + 2] = sample.acceleration[i];
            }
            ready_ = 1;
        }

        constexpr void evaluate(Scalar* xi) const noexcept {
            for (int element = 0; element < 3 * joints_; ++element) {
                xi[element] = constants_->scale[element] * state_[element];
            }
        }

        [[nodiscard]] static constexpr std::int64_t cost(int joints, int /*lags*/, int /*rows*/) noexcept {
            return std::int64_t{joints} * 3;
        }

        [[nodiscard]] static constexpr std::int64_t state_bytes(int joints, int /*lags*/,
                                                                int /*rows*/) noexcept {
            return storage_bytes<Scalar>(std::int64_t{3} * joints);
        }

        /// Returns the maximum stack bytes of `push` and `evaluate`.
        [[nodiscard]] static constexpr std::int64_t stack_bytes() noexcept { return frame_bytes; }

      private:
        using State = Storage<Scalar, product(n, 3)>;

        const Constants* constants_;
        [[no_unique_address]] Extent<n> joints_;
        State state_;
        int ready_ = 0;
    };
};

} // namespace dfdyn
