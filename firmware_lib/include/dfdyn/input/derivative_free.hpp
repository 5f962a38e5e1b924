// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/core/lag_window.hpp"
#include "dfdyn/sample.hpp"

namespace dfdyn {

/// Input DF: ξ_i = q_i(t⁻), the last M+1 positions (paper, Section V-A, R = I), scaled.
///
/// An input is a type with its sizes, an `identity` and a class `Map`. The identity differs between inputs
/// and is part of a snapshot. The map stores the past positions that it needs (`push`), reports when it has
/// enough (`ready`), and computes ξ (`evaluate`). Element (i, j) of ξ, feature j of joint i, has index i·k +
/// j. Cost of `evaluate`: n (M+1) multiplications.
template <int M>
struct DerivativeFree {
    static constexpr int identity = 1;
    static constexpr int lags = M;
    static constexpr int features_per_joint = sum(M, 1);
    template <class Scalar, int n, int m>
    using Sample = dfdyn::Sample<Scalar, n, m>;

    template <class Scalar, int n>
    struct Constants {
        Storage<Scalar, product(n, features_per_joint)>
            scale; ///< per element of ξ: 1 / (its standard deviation)
    };

    template <class Scalar, int n>
    class Map {
      public:
        using Constants = DerivativeFree::Constants<Scalar, n>;

        constexpr Map(const Constants& constants, Extent<n> joints, Extent<M> lag_count,
                      Extent<features_per_joint> /*rows*/) noexcept
            : scale_(constants.scale.data()), joints_(joints), window_(joints, lag_count) {}

        constexpr void restart() noexcept { window_.restart(); }
        [[nodiscard]] constexpr bool ready() const noexcept { return window_.full(); }

        template <class AnySample>
        constexpr void push(const AnySample& sample) noexcept {
            window_.push(sample.position.data());
        }

        constexpr void evaluate(Scalar* xi) const noexcept {
            for (int i = 0; i < joints_; ++i) {
                for (int lag = 0; lag < window_.capacity(); ++lag) {
                    const int element = i * window_.capacity() + lag;
                    xi[element] = scale_[element] * window_.row(lag)[i];
                }
            }
        }

        [[nodiscard]] static constexpr std::int64_t cost(int joints, int lag_count, int /*rows*/) noexcept {
            return std::int64_t{joints} * (lag_count + 1);
        }

        [[nodiscard]] static constexpr std::int64_t state_bytes(int joints, int lag_count,
                                                                int /*rows*/) noexcept {
            return LagWindow<Scalar, n, M>::state_bytes(joints, lag_count);
        }

        /// Returns the maximum stack bytes of `push` and `evaluate`.
        [[nodiscard]] static constexpr std::int64_t stack_bytes() noexcept { return frame_bytes; }

      private:
        const Scalar* scale_;
        [[no_unique_address]] Extent<n> joints_;
        LagWindow<Scalar, n, M> window_;
    };
};

/// Input DFW: ξ_i = diag(r) q_i(t⁻) (paper, Section V-A). The weight of each lag is part of the element's
/// scale, so the computation is the same as for DF.
template <int M>
struct DerivativeFreeWeighted : DerivativeFree<M> {
    static constexpr int identity = 2;
};

} // namespace dfdyn
