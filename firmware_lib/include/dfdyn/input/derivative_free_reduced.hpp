// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/core/lag_window.hpp"
#include "dfdyn/sample.hpp"

namespace dfdyn {

/// Writes k rows of R, each over M+1 lags, in difference form: R q = r'_0 q(t) + Σ_{l≥1} r'_l (q(t-l) -
/// q(t)), where r'_0 is the sum of the row and the other entries are those of R. Rows that differentiate have
/// a sum near zero; taking the differences first avoids cancellation in single precision. `rows` may be
/// `difference_rows`.
template <class Scalar>
constexpr void to_difference_form(const Scalar* rows, int row_count, int lags,
                                  Scalar* difference_rows) noexcept {
    for (int j = 0; j < row_count; ++j) {
        Scalar total = 0;
        for (int lag = 0; lag <= lags; ++lag) {
            const Scalar value = rows[j * (lags + 1) + lag];
            total += value;
            difference_rows[j * (lags + 1) + lag] = value;
        }
        difference_rows[j * (lags + 1)] = total;
    }
}

/// Input DFR: ξ_i = R q_i(t⁻) with k free rows, shared by the joints (paper, Section V-B); row 0 is the
/// position by convention. Cost of `evaluate`: n k (M+1) multiply-adds.
template <int M, int k>
struct DerivativeFreeReduced {
    static_assert(k == dynamic || M == dynamic || k <= M + 1, "more rows than lags: use DerivativeFree");
    static constexpr int identity = 3;
    static constexpr int lags = M;
    static constexpr int features_per_joint = k;
    template <class Scalar, int n, int m>
    using Sample = dfdyn::Sample<Scalar, n, m>;

    template <class Scalar, int n>
    struct Constants {
        Storage<Scalar, product(k, sum(M, 1))>
            rows;                             ///< k × (M+1), row-major, newest lag first, in difference form
        Storage<Scalar, product(n, k)> scale; ///< per element of ξ: relevance / standard deviation
    };

    template <class Scalar, int n>
    class Map {
      public:
        using Constants = DerivativeFreeReduced::Constants<Scalar, n>;

        constexpr Map(const Constants& constants, Extent<n> joints, Extent<M> lag_count,
                      Extent<k> rows) noexcept
            : constants_(&constants), joints_(joints), rows_(rows), window_(joints, lag_count) {}

        constexpr void restart() noexcept { window_.restart(); }
        [[nodiscard]] constexpr bool ready() const noexcept { return window_.full(); }

        template <class AnySample>
        constexpr void push(const AnySample& sample) noexcept {
            window_.push(sample.position.data());
        }

        constexpr void evaluate(Scalar* xi) const noexcept {
            const Scalar* newest = window_.row(0);
            for (int i = 0; i < joints_; ++i) {
                for (int j = 0; j < rows_; ++j) {
                    const Scalar* row = constants_->rows.data() + j * window_.capacity();
                    Scalar feature = row[0] * newest[i];
                    for (int lag = 1; lag < window_.capacity(); ++lag) {
                        feature += row[lag] * (window_.row(lag)[i] - newest[i]);
                    }
                    xi[i * rows_ + j] = constants_->scale[i * rows_ + j] * feature;
                }
            }
        }

        [[nodiscard]] static constexpr std::int64_t cost(int joints, int lag_count, int rows) noexcept {
            return std::int64_t{joints} * rows * (lag_count + 2);
        }

        [[nodiscard]] static constexpr std::int64_t state_bytes(int joints, int lag_count,
                                                                int /*rows*/) noexcept {
            return LagWindow<Scalar, n, M>::state_bytes(joints, lag_count);
        }

        /// Returns the maximum stack bytes of `push` and `evaluate`.
        [[nodiscard]] static constexpr std::int64_t stack_bytes() noexcept { return frame_bytes; }

      private:
        const Constants* constants_;
        [[no_unique_address]] Extent<n> joints_;
        [[no_unique_address]] Extent<k> rows_;
        LagWindow<Scalar, n, M> window_;
    };
};

} // namespace dfdyn
