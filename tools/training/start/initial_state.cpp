// SPDX-License-Identifier: Apache-2.0
#include "tools/training/start/initial_state.hpp"

#include "tools/training/start/batch_start.hpp"
#include "tools/training/start/normal_equations.hpp"

#include <utility>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Outputs and columns of the problem in units of noise_std.
struct ScaledProblem {
    MatrixXd outputs; // N x m
    MatrixXd columns; // N x (m p)
    Index p = 0;

    explicit ScaledProblem(const PhysicsProblem& problem)
        : outputs(scaled_outputs(problem.model.outputs, problem.data.outputs, problem.rows)),
          columns(problem.columns), p(problem.columns.cols() / outputs.cols()) {
        for (Index k = 0; k < outputs.cols(); ++k) {
            columns.middleCols(k * p, p) /= problem.model.outputs.noise_std[static_cast<std::size_t>(k)];
        }
    }

    void weigh(double forgetting_factor) {
        const VectorXd roots = forgetting_roots(forgetting_factor, outputs.rows());
        outputs = roots.asDiagonal() * outputs;
        columns = roots.asDiagonal() * columns;
    }

    auto columns_of(Index k) const { return columns.middleCols(k * p, p); }
};

/// Normal equations Lambda pi = b of the physics alone, with its prior.
NormalEquations physics_equations(const PhysicsProblem& problem, const ParameterPrior& prior) {
    ScaledProblem scaled(problem);
    scaled.weigh(problem.model.forgetting_factor);
    NormalEquations equations{MatrixXd::Zero(scaled.p, scaled.p), MatrixXd::Zero(scaled.p, 1)};
    for (Index k = 0; k < scaled.outputs.cols(); ++k) {
        equations.information.selfadjointView<Eigen::Lower>().rankUpdate(scaled.columns_of(k).transpose());
        equations.right_hand_side += scaled.columns_of(k).transpose() * scaled.outputs.col(k);
    }
    const double weight = prior_weight(problem.model.forgetting_factor, scaled.outputs.rows());
    equations.information += weight * prior.information;
    equations.right_hand_side += weight * (prior.information * prior.mean);
    return equations;
}

PhysicsStart solved(NormalEquations equations, const ParameterPrior& prior) {
    const CovarianceFactor factor =
        information_factor(std::move(equations.information), 1 / prior.information.diagonal().minCoeff());
    PhysicsStart start;
    start.parameters = factor.solve(equations.right_hand_side).col(0);
    store_inverse(factor, start.unit_upper, start.diagonal);
    return start;
}

/// Phi' [Y~ psi~], with the targets of all outputs side by side.
MatrixXd targets_of(const PhysicsProblem& problem) {
    const ScaledProblem scaled(problem);
    MatrixXd targets(scaled.outputs.rows(), scaled.outputs.cols() + scaled.columns.cols());
    targets << scaled.outputs, scaled.columns;
    return targets;
}

} // namespace

ParameterPrior ParameterPrior::independent(Index p, double prior_variance) {
    return {VectorXd::Zero(p), MatrixXd::Identity(p, p) / prior_variance};
}

InitialState parametric_start(const PhysicsProblem& problem, const ParameterPrior& prior) {
    return {{}, solved(physics_equations(problem, prior), prior)};
}

InitialState residual_start(const PhysicsProblem& problem, const VectorXd& parameters) {
    ScaledProblem scaled(problem);
    for (Index k = 0; k < scaled.outputs.cols(); ++k) {
        scaled.outputs.col(k) -= scaled.columns_of(k) * parameters;
    }
    return {batch_start(problem.model, problem.data, problem.rows, scaled.outputs), {parameters, {}, {}, {}}};
}

InitialState joint_initial_state(const PhysicsProblem& problem, const ParameterPrior& prior) {
    const auto samples = static_cast<Index>(problem.rows.size());
    const auto count = static_cast<Index>(problem.model.outputs.noise_std.size());
    const Index p = problem.columns.cols() / count;
    NormalEquations kernel = normal_equations(problem.model, problem.data, problem.rows, targets_of(problem));
    kernel.information.diagonal().array() +=
        prior_weight(problem.model.forgetting_factor, samples) / problem.model.outputs.prior_variance;
    const CovarianceFactor factor =
        information_factor(std::move(kernel.information), problem.model.outputs.prior_variance);
    const MatrixXd solution = factor.solve(kernel.right_hand_side); // [A_1 … A_m, G_1 … G_m]
    NormalEquations schur = physics_equations(problem, prior);
    std::vector<MatrixXd> couplings;
    for (Index k = 0; k < count; ++k) {
        const MatrixXd coupling = solution.middleCols(count + k * p, p);
        const auto products = kernel.right_hand_side.middleCols(count + k * p, p); // Phi' psi~_k
        schur.information -= products.transpose() * coupling;
        schur.right_hand_side -= coupling.transpose() * kernel.right_hand_side.col(k);
        couplings.push_back(coupling);
    }
    InitialState start{{}, solved(std::move(schur), prior)};
    start.physics.coupling = std::move(couplings);
    start.kernel.weights.assign(solution.data(), solution.data() + solution.rows() * count);
    store_inverse(factor, start.kernel.unit_upper, start.kernel.diagonal);
    return start;
}

InitialState initial_state_of(const Structure& structure, const PhysicsProblem& problem,
                              const ParameterPrior& prior, const std::optional<VectorXd>& fixed) {
    if (fixed && !structure.learns_parameters()) {
        return residual_start(problem, *fixed);
    }
    InitialState start =
        structure.fits_jointly() ? joint_initial_state(problem, prior) : parametric_start(problem, prior);
    return structure.learns_parameters() ? start : residual_start(problem, start.physics.parameters);
}

} // namespace dfdyn::tools
