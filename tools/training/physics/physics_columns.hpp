// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/data/motion.hpp"
#include "tools/training/physics/column_selection.hpp"
#include "tools/training/physics/regressor.hpp"

#include <Eigen/Core>

#include <memory>

namespace dfdyn::tools {

/// The physics' columns Psi of a set of samples, as a differentiable function of the input's parameters and
/// some of its own.
class PhysicsColumns {
  public:
    PhysicsColumns() = default;
    PhysicsColumns(const PhysicsColumns&) = delete;
    PhysicsColumns& operator=(const PhysicsColumns&) = delete;
    virtual ~PhysicsColumns() = default;

    virtual Eigen::Index columns() const = 0; ///< p
    virtual Bounds bounds() const = 0;        ///< of its own parameters, possibly none

    /// Returns the initial values of its own parameters if those of the input are `input`.
    virtual Eigen::VectorXd start(const Eigen::VectorXd& input) const = 0;

    /// Returns N x (m p): columns k p … k p + p - 1 are Psi_k, those of output k. `parameters`: the input's,
    /// then its own.
    virtual Eigen::MatrixXd evaluate(const Eigen::VectorXd& parameters) const = 0;

    /// Returns the gradient with respect to `parameters`, from the one with respect to evaluate(parameters).
    virtual Eigen::VectorXd pull_back(const Eigen::VectorXd& parameters,
                                      const Eigen::MatrixXd& gradient) const = 0;
};

/// A regressor of the motion: the selected columns, each times its scale.
class RegressorColumns final : public PhysicsColumns {
  public:
    /// Refers to `regressor`, which must outlive it. `choice.scale` has one entry per `choice.columns`.
    RegressorColumns(const Regressor& regressor, std::unique_ptr<LearnedMotion> motion, ColumnChoice choice)
        : regressor_(regressor), motion_(std::move(motion)), choice_(std::move(choice)) {}

    Eigen::Index columns() const override { return choice_.scale.size(); }
    Bounds bounds() const override { return motion_->bounds(); }
    Eigen::VectorXd start(const Eigen::VectorXd& input) const override { return motion_->start(input); }
    Eigen::MatrixXd evaluate(const Eigen::VectorXd& parameters) const override;
    Eigen::VectorXd pull_back(const Eigen::VectorXd& parameters,
                              const Eigen::MatrixXd& gradient) const override;

  private:
    const Regressor& regressor_;
    std::unique_ptr<LearnedMotion> motion_;
    ColumnChoice choice_;
};

/// Returns the chosen columns of the regressor, each times its scale: N x (m p).
Eigen::MatrixXd chosen_columns(const Regressor& regressor, const MotionSamples& motion,
                               const ColumnChoice& choice);

/// Returns all columns of the regressor, not scaled: N x (m P).
Eigen::MatrixXd all_columns(const Regressor& regressor, const MotionSamples& motion);

} // namespace dfdyn::tools
