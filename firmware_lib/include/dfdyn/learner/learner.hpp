// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/core/storage.hpp"

#include <concepts>
#include <cstdint>

namespace dfdyn {

/// Initial state of a learner, in the scale of the noise (see `LearnerConstants`): weights, and the factor P
/// = U D U' of their covariance, as computed by the training tool.
template <class Scalar, int p, int m>
struct LearnerStart {
    static constexpr int upper_size(int columns) noexcept {
        return columns == dynamic ? dynamic : (columns > 1 ? columns * (columns - 1) / 2 : 1);
    }

    Storage<Scalar, product(m, p)> weights; ///< m × p, row-major
    Storage<Scalar, upper_size(p)>
        unit_upper;              ///< U above its diagonal, by columns: column j holds rows 0 … j-1
    Storage<Scalar, p> diagonal; ///< D, positive
};

/// Constants of the regression y = φ'w + e of m outputs over the same p columns, each output in units of its
/// own noise: e ~ N(0, 1), w ~ N(0, prior_variance I), so that all outputs share one factor.
template <class Scalar, int p, int m>
struct LearnerConstants {
    Scalar prior_variance;    ///< ρ²/σ² > 0
    Scalar forgetting_factor; ///< λ, 1 - 1/p ≤ λ ≤ 1; 1 reproduces the paper
    static constexpr std::int64_t start_bytes = sizeof(LearnerStart<Scalar, p, m>);
    /// nullptr: zero weights and the prior's covariance.
    const LearnerStart<Scalar, p, m>* start;
};

/// Recursive least squares in a square-root form.
///
/// `identity` differs between forms and is part of a snapshot.
///
/// With λ = 1 the recursion is exact: after any number of rows, weights and covariance are those of the batch
/// solution (paper, Section IV-B). With λ < 1 the same holds with the weight λ^(N-t) of row t, as long as the
/// account of `Forgetting` covers it and no parameter's variance exceeds the prior's. Otherwise forgetting is
/// reduced and the variance is bounded. Rows and targets must be finite.
///  - `predict(row, means)`: computes the m means φ'w. O(m p).
///  - `variance(row)`: returns φ'Pφ of the last complete state, also while a row is being learned. O(p²).
///  - `begin(row, target, noise_variance)`: when `idle()`, begins to learn a row with targets measured with
///    `noise_variance` in units of their noise variance (default 1).
///  - `reset_covariance()`: when `idle()`, begins to reset the covariance to the prior's, in `advance`.
///  - `advance(budget)`: continues the present task; true when nothing is left to do.
///  - `sample_pending()`: the row is not learned yet. With forgetting, more work follows after it is.
///  - `last_variance_ratio()`: returns 1 + φ'Pφ of the last row, before it was learned.
///  - `reset()`: returns to the initial state.
template <class L, class Scalar>
concept Learner = requires(L learner, const L& constant, const Scalar* row, Scalar* means, Budget& budget) {
    { learner.reset() }
    noexcept;
    { constant.predict(row, means) }
    noexcept;
    { constant.variance(row) }
    noexcept->std::same_as<Scalar>;
    { constant.idle() }
    noexcept->std::same_as<bool>;
    { constant.sample_pending() }
    noexcept->std::same_as<bool>;
    learner.begin(row, row);
    { learner.begin(row, row, *row) }
    noexcept;
    { learner.reset_covariance() }
    noexcept;
    { learner.advance(budget) }
    noexcept->std::same_as<bool>;
    { constant.last_variance_ratio() }
    noexcept->std::same_as<Scalar>;
};

} // namespace dfdyn
