// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/bounds.hpp"
#include "tools/base/numerics/random_source.hpp"
#include "tools/model/model.hpp"

#include <Eigen/Core>

#include <memory>

namespace dfdyn::tools {

/// xi_(i,j) = gain_j * (row_j' q_i(t^-)) / (its standard deviation for joint i). The length of a row has no
/// influence.
struct InputRows {
    Eigen::MatrixXd rows; ///< k x (M+1)
    Eigen::VectorXd gain; ///< k relevance gains > 0; gain_0 = 1, since the length scale has the same effect
};

/// Gradient of a scalar with respect to InputRows.
struct InputRowsGradient {
    Eigen::MatrixXd rows;
    Eigen::VectorXd gain;
};

/// Returns the bounds of `count` relevance gains that are learned as logarithms: from negligible (1e-3) to
/// dominant (1e3).
Bounds log_gain_bounds(Eigen::Index count);

/// Returns `base` for the first `fixed` starts, and `base` plus normal noise of standard deviation 0.5 for
/// later ones.
Eigen::VectorXd perturbed(const Eigen::VectorXd& base, int index, int fixed, NormalSource& random);

/// Parametrization of the rows of R by a few free parameters (paper, Section V). One class per input kind.
class RowFamily {
  public:
    RowFamily() = default;
    RowFamily(const RowFamily&) = delete;
    RowFamily& operator=(const RowFamily&) = delete;
    virtual ~RowFamily() = default;

    virtual Bounds bounds() const = 0; ///< one entry per parameter
    virtual InputRows evaluate(const Eigen::VectorXd& parameters) const = 0;

    /// Chain rule from the rows to the parameters.
    virtual Eigen::VectorXd pull_back(const Eigen::VectorXd& parameters,
                                      const InputRowsGradient& gradient) const = 0;

    /// Returns the initial parameters of start number `index` = 0, 1, …; the first ones are fixed, further
    /// ones perturbed.
    virtual Eigen::VectorXd start(int index, NormalSource& random) const = 0;

    /// Returns the factors of the gains that the stored matrix R includes: R = diag(factor) rows, scale =
    /// gain / (factor s).
    virtual Eigen::VectorXd stored_gain(const InputRows& rows) const = 0;

    /// Returns the parameters that result in `rows` and their gains, up to the lengths of the rows; those of
    /// further rows are taken from `others`. Families without free rows return `others`.
    virtual Eigen::VectorXd parameters_of(const InputRows& /*rows*/, Eigen::VectorXd others) const {
        return others;
    }

    /// Sets the fields of this family only, such as the poles of filters.
    virtual void describe(const Eigen::VectorXd& /*parameters*/, InputModel& /*model*/) const {}
};

} // namespace dfdyn::tools
