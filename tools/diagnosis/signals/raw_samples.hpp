// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/measured_motion.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// The outputs of a recording as measured, without any filter, and their positions among the rows of the
/// motion, which may have a lower rate.
struct RawSamples {
    Eigen::MatrixXd outputs;        ///< S x m, in the recording's units
    std::vector<Eigen::Index> rows; ///< S: first of the four rows of the motion for the interpolation
    Eigen::MatrixX4d weights;       ///< S x 4, of these rows

    /// Interpolates a series of the motion's rows, T x c, at the samples by cubic polynomials: S x c.
    Eigen::MatrixXd at(const Eigen::MatrixXd& series) const;
    /// Nearest row of the motion.
    Eigen::Index nearest(Eigen::Index sample) const;
    /// Number of samples before a row of the motion.
    Eigen::Index before(Eigen::Index row) const;
};

/// Returns the samples within the segments of the motion. Cost: O(rows).
RawSamples raw_samples(const Recording& recording, const MeasuredMotion& measured);

/// Returns the motion's rows themselves as samples of `outputs`, T x m.
RawSamples own_samples(const MeasuredMotion& measured, Eigen::MatrixXd outputs);

} // namespace dfdyn::tools
