// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/common_parameters.hpp"

#include <algorithm>

namespace dfdyn {

/// Constants of the two parts of a block-arrow regression (see `BlockArrow`). The initial weights of
/// `features` are, per output, those of y followed by those of its p columns ψ.
template <class Scalar, int columns, int p, int m>
struct BlockArrowConstants {
    LearnerConstants<Scalar, columns, product(m, sum(p, 1))> features; ///< regressions on φ
    LearnerConstants<Scalar, p, 1> common;                             ///< regression of π
    /// Bytes of the initial states that the constants refer to.
    static constexpr std::int64_t start_bytes =
        decltype(features)::start_bytes + decltype(common)::start_bytes;
};

/// The tasks of `BlockArrow`, in their order. From `forget` on, no sample is pending.
enum class ArrowTask : int {
    none,
    residual,
    sweep,
    common,
    weights,
    forget,
    bound,
    reset_factor,
    reset_coupling,
    reset_parameters
};

/// Residual of one sample's outputs y_k and of their own columns ψ_k, after regression on φ.
template <class Scalar, int p, int m>
struct ArrowResidual {
    Storage<Scalar, product(m, p)> rows; ///< ψ̃, m × p
    Storage<Scalar, m> output;           ///< of the present sample φ'a_k, of a pending one ẽ_k

    /// Returns a residual of `outputs` outputs and `parameters` columns that is 0.
    static ArrowResidual zeros(Extent<p> parameters, Extent<m> outputs) noexcept {
        return {Storage<Scalar, product(m, p)>::zeros(extent<product(m, p)>(outputs * parameters)),
                Storage<Scalar, m>::zeros(outputs)};
    }

    /// Sets all numbers to 0.
    void clear() noexcept {
        std::fill(rows.begin(), rows.end(), Scalar(0));
        std::fill(output.begin(), output.end(), Scalar(0));
    }
};

/// Work and memory of `BlockArrow`, for counts of columns, parameters and outputs.
template <class Scalar, int columns, int p, int m>
class BlockArrowFootprint {
  public:
    /// Returns the cost of the parts of a tick in multiply-adds.
    [[nodiscard]] static constexpr Cost cost(int column_count, int parameters, int outputs) noexcept {
        const Cost shared = CommonParameters<Scalar, p, m>::cost(parameters, outputs);
        const std::int64_t regressions = std::int64_t{outputs} * (1 + parameters);
        const std::int64_t sweep = Factor::sweep_cost(column_count);
        const std::int64_t variances = outputs * UdFactor<Scalar, p>::variance_cost(parameters);
        // While a sample is being learned, a tick also pays for `variance` during a sweep, or for the
        // additional work of `predict` while the weights change.
        const std::int64_t in_hand = std::max(Factor::sweeping_variance_cost(column_count) + shared.variance,
                                              column_count + 1 + regressions + variances);
        return {.predict = regressions * column_count + shared.predict,
                .variance = Factor::variance_cost(column_count) + in_hand,
                .learn = sweep + shared.learn + regressions * weights_cost(column_count),
                .forget = shared.forget + forget_cost(column_count) + sweep,
                .largest_step = std::max({Factor::largest_step(column_count), weights_cost(column_count),
                                          forget_cost(column_count), shared.largest_step}),
                .reset_covariance = Factor::reset_cost(column_count) + shared.reset_covariance +
                                    std::int64_t{outputs} * parameters * weights_cost(column_count)};
    }

    /// Returns the bytes of the stored numbers, without pointers and indices.
    [[nodiscard]] static constexpr std::int64_t state_bytes(int column_count, int parameters,
                                                            int outputs) noexcept {
        const std::int64_t residual =
            storage_bytes<Scalar>(std::int64_t{outputs} * parameters) + storage_bytes<Scalar>(outputs);
        return Factor::state_bytes(column_count) +
               CommonParameters<Scalar, p, m>::state_bytes(parameters, outputs) +
               storage_bytes<Scalar>(std::int64_t{outputs} * (1 + parameters) *
                                     Factor::padded(column_count)) +
               2 * residual;
    }

    /// Returns the maximum stack bytes over all calls.
    [[nodiscard]] static constexpr std::int64_t stack_bytes() noexcept {
        return frame_bytes + 76 * std::int64_t{sizeof(Scalar)};
    }

  protected:
    using Factor = UdFactor<Scalar, columns>; ///< of P, which all outputs share

    /// Multiply-adds to update the weights of one regression.
    static constexpr std::int64_t weights_cost(int column_count) noexcept {
        return std::int64_t{column_count} + 1;
    }
    /// Multiply-adds to apply forgetting to P.
    static constexpr std::int64_t forget_cost(int column_count) noexcept {
        return Forgetting<Scalar>::cost + 2 + Factor::scale_and_bound_cost(column_count);
    }
};

} // namespace dfdyn
