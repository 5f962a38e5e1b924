// SPDX-License-Identifier: Apache-2.0
// Effects that begin, or occur, at an unknown time.
#pragma once

#include "tools/diagnosis/candidates/effect_regression.hpp"
#include "tools/diagnosis/candidates/event_windows.hpp"

#include <optional>
#include <vector>

namespace dfdyn::tools {

inline constexpr double events_apart_s = 2; ///< windows closer than this belong to the same event

/// Returns the minimum log-evidence required of an event: three times the log-evidence of the fourth-best
/// event. Empty if fewer than four events exist.
std::optional<double> noise_event_threshold(const std::vector<EventWindow>& events);

/// Returns, per output, the ratio of a series' energy after weighting by the noise to its energy before.
Eigen::VectorXd weighted_share(const EffectRegression& regression, const Eigen::VectorXd& series);

/// Per row, the products of the weighted residual with some columns (p), and of the columns with each other
/// (p (p + 1) / 2), summed over the outputs.
struct EventProducts {
    Eigen::MatrixXd moment, square;
    Eigen::Index columns;

    EventProducts(const std::vector<EffectColumn>& of, const Eigen::MatrixXd& weighted,
                  const Eigen::VectorXd& share);

    /// Returns the sum of squares that the columns explain, from these sums of products.
    double explained(const Eigen::VectorXd& moments, const Eigen::VectorXd& squares) const;
};

} // namespace dfdyn::tools
