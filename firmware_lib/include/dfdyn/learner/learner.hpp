// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/budget.hpp"
#include "dfdyn/storage.hpp"

#include <concepts>
#include <cstdint>

namespace dfdyn {

/// Where a learner starts, in the scale of the noise (see `LearnerConstants`): weights and the factor P = U D
/// U' of their covariance, as the training tool computed them.
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

/// The regression y = φ'w + e of m outputs over the same p columns, each output in units of its own noise: e
/// ~ N(0, 1), w ~ N(0, prior_variance I), so that one factor serves all.
template <class Scalar, int p, int m>
struct LearnerConstants {
    Scalar prior_variance;    ///< ρ²/σ² > 0
    Scalar forgetting_factor; ///< λ, 1 - 1/p ≤ λ ≤ 1; 1 reproduces the paper
    static constexpr std::int64_t start_bytes = sizeof(LearnerStart<Scalar, p, m>);
    const LearnerStart<Scalar, p, m>* start; ///< nullptr: zero weights and the prior's covariance
};

/// Recursive least squares in a square-root form.
///
/// `identity` is a number that differs from every other form's; it is part of a snapshot.
///
/// With λ = 1 the recursion is exact: after any number of rows, weights and covariance are those of the batch
/// solution of eq. ReLS. With λ < 1 the same holds, each row t weighed by λ^(N-t), as long as the account of
/// `Forgetting` pays for it and no parameter's variance exceeds the prior's; beyond, forgetting is reduced
/// and the variance is taken back. Rows and targets must be finite.
///  - `predict(row, means)`: the m means φ'w. O(m p).
///  - `variance(row)`: φ'Pφ of the last whole state, also while a row is being folded in. O(p²).
///  - `begin(row, target, noise_variance)`: takes a row in when `idle()`, with targets measured with
///    `noise_variance` in units of their noise variance, 1 without it.
///  - `reset_covariance()`: begins, when `idle()`, to set the covariance back to the prior's, in `advance`.
///  - `advance(budget)`: works on it and says whether there is nothing left to do.
///  - `sample_pending()`: the row is not learned yet; under forgetting there is more work after that.
///  - `last_ratio()`: 1 + φ'Pφ of the last row, before it was learned.
///  - `reset()`: back to the start, all of it.
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
    { constant.last_ratio() }
    noexcept->std::same_as<Scalar>;
};

} // namespace dfdyn
