// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/inputs/row_family.hpp"
#include "tools/training/data/lag_window.hpp"
#include "tools/training/data/training_data.hpp"

#include <Eigen/Core>

#include <memory>

namespace dfdyn::tools {

/// Position, velocity and acceleration of an arm: n joints each, in rad (m), per s and per s^2.
struct MotionState {
    Eigen::VectorXd position;
    Eigen::VectorXd velocity;
    Eigen::VectorXd acceleration;
};

/// Motion of a set of samples as the input of the physics: N x n each, in rad (m), per s, per s^2.
struct MotionSamples {
    Eigen::MatrixXd positions;
    Eigen::MatrixXd velocities;
    Eigen::MatrixXd accelerations;

    MotionState at(Eigen::Index row) const {
        return {positions.row(row).transpose(), velocities.row(row).transpose(),
                accelerations.row(row).transpose()};
    }
};

/// Gradient of a scalar with respect to MotionSamples.
struct MotionGradient {
    Eigen::MatrixXd velocities;
    Eigen::MatrixXd accelerations;
};

/// The motion of a set of samples as a differentiable function of the input's parameters followed by its own.
class LearnedMotion {
  public:
    LearnedMotion() = default;
    LearnedMotion(const LearnedMotion&) = delete;
    LearnedMotion& operator=(const LearnedMotion&) = delete;
    virtual ~LearnedMotion() = default;

    virtual Bounds bounds() const = 0; ///< of its own parameters
    virtual Eigen::VectorXd start(const Eigen::VectorXd& input) const = 0;
    virtual bool learns() const = 0; ///< whether any parameter changes it
    virtual MotionSamples evaluate(const Eigen::VectorXd& parameters) const = 0;

    /// Returns the gradient with respect to `parameters`.
    virtual Eigen::VectorXd pull_back(const Eigen::VectorXd& parameters,
                                      const MotionGradient& gradient) const = 0;
};

/// Velocity row and acceleration row, newest lag first: 2 x (M+1), in 1/s and 1/s^2, as a function of the
/// input's parameters followed by its own.
class MotionRows {
  public:
    MotionRows() = default;
    MotionRows(const MotionRows&) = delete;
    MotionRows& operator=(const MotionRows&) = delete;
    virtual ~MotionRows() = default;

    virtual Bounds bounds() const = 0; ///< of its own parameters
    virtual Eigen::VectorXd start(const Eigen::VectorXd& input) const = 0;
    virtual bool learns() const = 0;
    virtual Eigen::MatrixXd evaluate(const Eigen::VectorXd& parameters) const = 0;

    /// Applies the chain rule: returns the gradient with respect to `parameters`, from the gradient with
    /// respect to the rows.
    virtual Eigen::VectorXd pull_back(const Eigen::VectorXd& parameters,
                                      const Eigen::MatrixXd& gradient) const = 0;
};

/// Returns the recording's derivatives at `rows`, without parameters.
std::unique_ptr<LearnedMotion> given_motion(const TrainingData& data, const RowList& rows);

/// Returns the measured positions, and derivatives from each joint's last positions by `motion_rows`.
std::unique_ptr<LearnedMotion> lag_motion(const Eigen::MatrixXd& positions, const RowList& rows, int lags,
                                          std::unique_ptr<MotionRows> motion_rows);

/// Rows of the least-squares polynomial of degree 2 through the window, at its newest sample. 2 <= lags.
std::unique_ptr<MotionRows> polynomial_motion(int lags, double sample_period);

/// Rows of the first and second differences in the window, averaged with weights beta_1^t and beta_2^t: the
/// filters of DFSR in physical units, truncated so that ramps and parabolas have exact derivatives. logit
/// beta_1 and logit beta_2 are parameters number `first` and `first` + 1: those of the input (DFSR), or with
/// `own` separate ones that follow the `first` parameters of the input. 2 <= lags.
std::unique_ptr<MotionRows> difference_motion(int lags, double sample_period, Eigen::Index first, bool own);

/// Rows that are free but for their responses: velocity 0 to a constant position and 1 to a ramp of 1 per s,
/// acceleration 0 to both and 1 to a parabola of 1 per s^2. They may thus smooth noise or follow the newest
/// samples, but not change the scale of a motion. 2 M - 3 parameters after the `inputs` of the input; at 0
/// they are mean differences. 2 <= lags.
std::unique_ptr<MotionRows> free_motion(int lags, double sample_period, Eigen::Index inputs);

/// Returns the logarithms of the factors with which `rows` are closest to `wanted` (2 x (M+1) each), over the
/// windows of `pooled_factor`. If a row is orthogonal to the wanted one, the factor gives it the same length.
Eigen::VectorXd log_factors(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& wanted,
                            const Eigen::MatrixXd& pooled_factor);

/// Rows 2 and 3 of `family` (DFR: of length 1), times a factor each, learned as its logarithm. The initial
/// values are the log_factors() for the polynomial's rows. The family must have at least three rows.
std::unique_ptr<MotionRows> scaled_motion(std::unique_ptr<RowFamily> family, int lags, double sample_period,
                                          const Eigen::MatrixXd& pooled_factor);

} // namespace dfdyn::tools
