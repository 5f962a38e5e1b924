// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Of the columns of a regressor, those that are independent, and what their parameters stand for.
struct BaseParameters {
    std::vector<Eigen::Index> independent; ///< columns, ascending; as many as the rank
    /// rank x columns: base parameters = combination * all parameters; the identity in the independent
    /// columns.
    Eigen::MatrixXd combination;
    double gap = 0; ///< how far the first column left out is below the last one taken (ratio of |R_ii|)

    Eigen::Index count() const { return combination.rows(); }
};

/// Rank-revealing QR (column pivoting) of `regressor`, its columns scaled to the same length. The rank is
/// where the diagonal of R drops most, among the places where it falls below 1e-6 of its first entry; what is
/// below rounding (1e-14) counts as zero. The regressor of a structure is to be taken over states that excite
/// everything (`random_motion`), then the drop is many orders of magnitude: see `gap`. Any columns will do,
/// effects beside the rigid body's included.
BaseParameters find_base_parameters(const Eigen::MatrixXd& regressor);

/// Each base parameter in words, from the names of the columns: `link3 mcx + 0.39·link4 m`.
std::vector<std::string> base_parameter_names(const BaseParameters& base,
                                              const std::vector<std::string>& names);

} // namespace dfdyn::tools
