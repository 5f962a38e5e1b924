// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/signals.hpp"

#include <Eigen/Core>

namespace dfdyn::tools {

/// Plain least squares of each output by itself, as in textbooks on identification: gain · rigid body +
/// inertia · acceleration + viscous · velocity + dry · direction + offset, of the output's joint; for a
/// wrench gain · rigid body + offset.
struct TextbookFit {
    /// 5 x m: gain (1), inertia (kg·m²), viscous friction (N·m·s/rad), dry friction (N·m), offset (N·m)
    Eigen::MatrixXd coefficients;
    Eigen::MatrixXd prediction; ///< T x m, N·m (N)
};

/// Returns the columns of that model (T x 5, in the order of `TextbookTerm`) with the rigid body's output
/// `rigid` (T).
Eigen::MatrixXd textbook_columns(const DiagnosisSignals& signals, const Eigen::VectorXd& rigid,
                                 Eigen::Index output);

/// Fits the coefficients of `textbook_columns` (T x 5) to `measured` (T) with this gain. Returns all five.
/// All rows have the same weight.
Eigen::VectorXd coefficients_with_gain(const Eigen::MatrixXd& columns, const Eigen::VectorXd& measured,
                                       double gain);

/// Fits the first `rows` rows of `measured`, T x m, with the rigid body's outputs `rigid`, T x m. All rows
/// have the same weight. Where the rigid body's column depends on the others, as at a slide, the gain is 1.
/// Cost: O(25 T m).
TextbookFit textbook_fit(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                         const Eigen::MatrixXd& rigid, Eigen::Index rows);

/// Standard deviation of the rigid body's factor at a joint whose torque constant is given.
inline constexpr double known_gain_deviation = 0.03;

/// Returns whether data contradict that a factor is 1 ± `known_gain_deviation`: by three deviations. `gain`:
/// its estimate without this prior, with this variance.
bool contradicts_known_gain(double gain, double variance);

/// Returns the weights (T) of an output's rows (MeasuredMotion::weight).
Eigen::VectorXd row_weight(const DiagnosisSignals& signals, Eigen::Index output);

/// Returns the mean square of errors (T) with the rows' weights (T).
double weighted_mean_square(const Eigen::VectorXd& error, const Eigen::VectorXd& weight);

/// Plain least squares of one output in the rows in which its joint moves, with its uncertainty.
struct MovingFit {
    Eigen::MatrixXd columns;    ///< T x 5, in the order of `TextbookTerm`
    Eigen::VectorXd values;     ///< 5
    Eigen::MatrixXd covariance; ///< 5 x 5
    Eigen::Index blocks = 0;    ///< of time, from whose sums the covariance is computed
    bool another_gain = false;  ///< the data contradict the known factor 1 of the rigid body
};

/// Fits `measured` (T), with the rigid body's output `rigid` (T) and the rows' weights
/// (MeasuredMotion::weight). `gain_known`: the rigid body's factor is 1 ± 0.03, unless the data contradict it
/// by three deviations. Where the rigid body's column depends on the others, the factor is 1.
///
/// The covariance is computed from sums over blocks of 1 s, so that it includes noise with a shorter
/// correlation. A joint that moves for less than 20 s has blocks of a twentieth of that time, at least 0.25
/// s. Cost: O(25 T).
MovingFit fit_moving_rows(const DiagnosisSignals& signals, const Eigen::VectorXd& measured,
                          const Eigen::VectorXd& rigid, Eigen::Index output, bool gain_known);

} // namespace dfdyn::tools
