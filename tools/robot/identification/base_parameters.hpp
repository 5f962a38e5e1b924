// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

namespace dfdyn::tools {

/// The independent columns of a regressor, and the meaning of their parameters.
struct BaseParameters {
    std::vector<Eigen::Index> independent; ///< ascending; their number is the rank
    /// rank x columns: base parameters = combination * all parameters; identity in the independent columns.
    Eigen::MatrixXd combination;
    double gap = 0; ///< ratio of the last |R_ii| included to the first one excluded

    Eigen::Index count() const { return combination.rows(); }
};

/// Computes a rank-revealing QR decomposition (column pivoting) of `regressor`, with columns scaled to equal
/// length. The rank is at the largest drop of the diagonal of R among the places below 1e-6 of its first
/// entry; values below rounding (1e-14) count as zero. To find structural dependences, evaluate the regressor
/// over states with full excitation (`random_motion`); the drop is then many orders of magnitude: see `gap`.
/// The columns may include those of effects.
BaseParameters find_base_parameters(const Eigen::MatrixXd& regressor);

/// Returns the text of each base parameter from the names of the columns: `link3 mcx + 0.39·link4 m`.
std::vector<std::string> base_parameter_names(const BaseParameters& base,
                                              const std::vector<std::string>& names);

} // namespace dfdyn::tools
