// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/arm_fit.hpp"

#include "tools/diagnosis/verdict/arm_unknowns.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Time between independent samples of the residual. Chosen with the thirteen recordings of
/// tests/data/ur5_kufieta: 148 of 154 intervals of friction then contain the mean of the recordings.
constexpr double correlation_s = 0.1;

/// The normal equations of all joints. The unknowns are the links' parameters, then the terms of each joint,
/// all as differences from the robot's file.
class ArmEquations {
  public:
    ArmEquations(const DiagnosisSignals& signals, const MatrixXd& measured,
                 const std::vector<MovingFit>& plain)
        : signals_(signals), target_(measured - signals.nominal), rest_(target_), plain_(plain),
          links_(link_deviations(signals)) {
        for (Index joint = 0; joint < joints(); ++joint) {
            weight_.emplace_back(moving_weight(signals_, joint));
            const MovingFit& own = plain[static_cast<std::size_t>(joint)];
            variance_.push_back(
                weighted_mean_square(measured.col(joint) - own.columns * own.values, weight_.back()));
            add_products(joint);
        }
    }

    Index joints() const { return target_.cols(); }
    Index first_term(Index joint) const { return dfdyn::tools::first_term(signals_, joint); }

    /// Solves with these prior deviations of the gains (n), then estimates the noise from the residual.
    void solve(const VectorXd& gain_deviation) {
        const Index size = first_term(joints());
        MatrixXd system = MatrixXd::Zero(size, size);
        VectorXd moment = VectorXd::Zero(size);
        system.diagonal().head(links_.size()) = links_.cwiseAbs2().cwiseInverse();
        system.diagonal().tail(size - links_.size()).setConstant(1 / (unknown_deviation * unknown_deviation));
        for (Index joint = 0; joint < joints(); ++joint) {
            const auto number = static_cast<std::size_t>(joint);
            const double gain = gain_deviation[joint];
            system(first_term(joint), first_term(joint)) += 1 / (gain * gain);
            const double rows = std::max(1.0, correlation_s * signals_.measured.rate_hz);
            const double scale = 1 / (rows * std::max(variance_[number], 1e-12));
            const std::vector<Index> own = unknowns_of(signals_, joint);
            system(own, own) += scale * gram_[number];
            moment(own) += scale * moment_[number];
        }
        const Eigen::LDLT<MatrixXd> factor(system);
        values_ = factor.solve(moment);
        covariance_ = factor.solve(MatrixXd::Identity(size, size));
        for (Index joint = 0; joint < joints(); ++joint) {
            const auto number = static_cast<std::size_t>(joint);
            rest_.col(joint) = target_.col(joint) - columns(joint) * values_(unknowns_of(signals_, joint));
            variance_[number] = weighted_mean_square(rest_.col(joint), weight_[number]);
        }
    }

    VectorXd values(Index joint) const { return values_.segment(first_term(joint), terms_of_joint); }
    MatrixXd covariance(Index joint) const {
        return covariance_.block(first_term(joint), first_term(joint), terms_of_joint, terms_of_joint);
    }
    const MatrixXd& rest() const { return rest_; } ///< T x n: residual

  private:
    MatrixXd columns(Index joint) const {
        return arm_columns(signals_, joint, plain_[static_cast<std::size_t>(joint)].columns);
    }

    void add_products(Index joint) {
        const MatrixXd own = columns(joint);
        const MatrixXd weighted = weight_.back().asDiagonal() * own;
        gram_.emplace_back(own.transpose() * weighted);
        moment_.emplace_back(weighted.transpose() * target_.col(joint));
    }

    const DiagnosisSignals& signals_;
    MatrixXd target_, rest_;
    const std::vector<MovingFit>& plain_;
    VectorXd links_; ///< standard deviations of the links' parameters
    std::vector<VectorXd> weight_, moment_;
    std::vector<MatrixXd> gram_;
    std::vector<double> variance_; ///< per joint, of the residual
    VectorXd values_;
    MatrixXd covariance_;
};

/// Returns the gains' prior deviations: given torque constants are used unless the data contradict them.
VectorXd gain_deviations(const ArmEquations& free, bool gains_known) {
    VectorXd result = VectorXd::Constant(free.joints(), unknown_deviation);
    for (Index joint = 0; gains_known && joint < free.joints(); ++joint) {
        if (!contradicts_known_gain(1 + free.values(joint)[0], free.covariance(joint)(0, 0))) {
            result[joint] = known_gain_deviation;
        }
    }
    return result;
}

} // namespace

ArmFit fit_arm(const DiagnosisSignals& signals, const MatrixXd& measured, std::vector<MovingFit> plain,
               bool gains_known) {
    constexpr int rounds = 3; // the noise estimate has converged
    ArmEquations equations(signals, measured, plain);
    equations.solve(VectorXd::Constant(equations.joints(), unknown_deviation));
    const VectorXd gains = gain_deviations(equations, gains_known);
    for (int round = 0; round < rounds; ++round) {
        equations.solve(gains);
    }
    for (Index joint = 0; joint < equations.joints(); ++joint) {
        MovingFit& own = plain[static_cast<std::size_t>(joint)];
        own.values = equations.values(joint);
        own.values[0] += 1;
        own.covariance = equations.covariance(joint);
        own.another_gain = gains_known && gains[joint] > known_gain_deviation;
    }
    return {std::move(plain), equations.rest()};
}

} // namespace dfdyn::tools
