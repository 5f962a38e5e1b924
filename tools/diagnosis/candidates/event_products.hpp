// SPDX-License-Identifier: Apache-2.0
// Effects that begin, or happen, at a time that nobody knows.
#pragma once

#include "tools/diagnosis/candidates/effect_regression.hpp"
#include "tools/diagnosis/candidates/event_windows.hpp"

#include <optional>
#include <vector>

namespace dfdyn::tools {

inline constexpr double events_apart_s = 2; ///< windows closer than this tell of the same event

/// What an event has to explain before it is one; none where there are too few to compare with.
std::optional<double> demanded_by(const std::vector<EventWindow>& events);

/// Per output, how much energy a series has when it is weighed by the noise, of that before.
Eigen::VectorXd weighed_share(const EffectRegression& regression, const Eigen::VectorXd& series);

/// A series per row: of the weighed residual's products with some columns (p), and of their own (p (p + 1) /
/// 2), summed over the outputs.
struct EventProducts {
    Eigen::MatrixXd moment, square;
    Eigen::Index columns;

    EventProducts(const std::vector<EffectColumn>& of, const Eigen::MatrixXd& weighed,
                  const Eigen::VectorXd& share);

    /// Sum of squares that the columns explain where these are the sums of their products.
    double gain(const Eigen::VectorXd& moments, const Eigen::VectorXd& squares) const;
};

} // namespace dfdyn::tools
