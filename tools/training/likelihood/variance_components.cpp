// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/variance_components.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double widest_log_prior = 25;
constexpr double log_noise_range = 40;
constexpr int expectation_steps = 10;
constexpr int newton_steps_most = 300;
constexpr double longest_step = 3; // of a logarithm
constexpr double damping_most = 1e12;

/// Returns the outputs' variances without physics, and a prior for which the physics has the same size.
VectorXd first_guess(const LinearStatistics& statistics, PhysicsPrior prior) {
    const Index outputs = outputs_of(statistics);
    const auto samples = static_cast<double>(statistics.samples);
    VectorXd x(outputs + prior_groups(statistics, prior));
    x.head(outputs) = (statistics.output_squares / samples).array().log();
    VectorXd sizes = VectorXd::Zero(columns_of(statistics));
    for (Index k = 0; k < outputs; ++k) {
        sizes += statistics.squares[static_cast<std::size_t>(k)].diagonal() / std::exp(x[k]);
    }
    const double energy = samples * static_cast<double>(outputs);
    x.tail(prior_groups(statistics, prior)).setConstant(std::log(energy / sizes.sum()));
    return x;
}

/// One step of expectation-maximization from x; it needs the gradient only. Returns nothing if a variance
/// would vanish.
std::optional<VectorXd> expectation_step(const LinearStatistics& statistics, PhysicsPrior prior,
                                         const VectorXd& x) {
    const auto at = variance_criterion(statistics, prior, x);
    if (!at) {
        return std::nullopt;
    }
    VectorXd weight = VectorXd::Constant(x.size(), static_cast<double>(statistics.samples));
    const Index groups = prior_groups(statistics, prior);
    weight.tail(groups).setConstant(static_cast<double>(columns_of(statistics)) /
                                    static_cast<double>(std::max<Index>(groups, 1)));
    const VectorXd factor = 1 - at->gradient.cwiseQuotient(weight).array();
    if (!(factor.minCoeff() > 0)) {
        return std::nullopt;
    }
    return x + factor.array().log().matrix();
}

/// Damped Newton method within bounds.
class Newton {
  public:
    Newton(const LinearStatistics& statistics, PhysicsPrior prior, VectorXd lower, VectorXd upper)
        : statistics_(statistics), prior_(prior), lower_(std::move(lower)), upper_(std::move(upper)),
          tolerance_(1e-11 * static_cast<double>(statistics.samples)) {}

    /// Returns nothing unless the minimum within the bounds was reached, to a loose tolerance: otherwise
    /// gradients of dependent quantities would be wrong.
    std::optional<VarianceCriterion> run(VectorXd& x) const {
        auto here = variance_criterion(statistics_, prior_, x);
        double damping = 1e-3;
        for (int i = 0; here && i < newton_steps_most && damping < damping_most; ++i) {
            if (slope(*here, x) <= tolerance_) {
                break;
            }
            const VectorXd next = moved(*here, x, damping);
            auto there = variance_criterion(statistics_, prior_, next);
            if (there && better(*there, next, *here, x)) {
                x = next;
                here = std::move(there);
                damping = damping < 1e-9 ? 0 : damping / 10;
            } else {
                damping = std::max(10 * damping, 1e-6);
            }
        }
        return here && slope(*here, x) <= loose * tolerance_ ? here : std::nullopt;
    }

  private:
    static constexpr double loose = 1e5;

    /// 1 for coordinates that are not held at a bound.
    VectorXd free(const VarianceCriterion& at, const VectorXd& x) const {
        VectorXd result = VectorXd::Ones(x.size());
        for (Index i = 0; i < x.size(); ++i) {
            const bool held =
                (x[i] <= lower_[i] && at.gradient[i] > 0) || (x[i] >= upper_[i] && at.gradient[i] < 0);
            result[i] = held ? 0 : 1;
        }
        return result;
    }

    double slope(const VarianceCriterion& at, const VectorXd& x) const {
        return free(at, x).cwiseProduct(at.gradient).cwiseAbs().maxCoeff();
    }

    /// Returns whether a point is lower, or equal within rounding errors and flatter.
    bool better(const VarianceCriterion& there, const VectorXd& next, const VarianceCriterion& here,
                const VectorXd& x) const {
        const double rounding = 1e-12 * std::abs(here.value);
        return there.value < here.value - rounding ||
               (there.value <= here.value + rounding && slope(there, next) < slope(here, x));
    }

    VectorXd moved(const VarianceCriterion& at, const VectorXd& x, double damping) const {
        const VectorXd open = free(at, x);
        MatrixXd matrix = open.asDiagonal() * at.hessian * open.asDiagonal();
        matrix.diagonal() += damping * at.hessian.diagonal().cwiseAbs() + (1 - open.array()).matrix();
        const Eigen::LLT<MatrixXd> factor(matrix);
        if (factor.info() != Eigen::Success) {
            return x; // no improvement: the damping increases
        }
        VectorXd step = -factor.solve(open.cwiseProduct(at.gradient));
        step *= std::min(1.0, longest_step / std::max(step.cwiseAbs().maxCoeff(), 1e-300));
        return (x + step).cwiseMax(lower_).cwiseMin(upper_);
    }

    const LinearStatistics& statistics_;
    PhysicsPrior prior_;
    VectorXd lower_, upper_;
    double tolerance_;
};

} // namespace

std::optional<VarianceComponents> best_variances(const LinearStatistics& statistics, PhysicsPrior prior,
                                                 const std::optional<VectorXd>& log_prior) {
    VectorXd x = first_guess(statistics, prior);
    VectorXd range = VectorXd::Constant(x.size(), log_prior ? 0 : widest_log_prior);
    range.head(outputs_of(statistics)).setConstant(log_noise_range);
    if (log_prior) {
        x.tail(log_prior->size()) = *log_prior;
    }
    const VectorXd lower = x - range;
    const VectorXd upper = x + range;
    for (int i = 0; i < expectation_steps; ++i) {
        const auto next = expectation_step(statistics, prior, x);
        if (!next) {
            return std::nullopt;
        }
        x = next->cwiseMax(lower).cwiseMin(upper);
    }
    auto at = Newton(statistics, prior, lower, upper).run(x);
    if (!at) {
        return std::nullopt;
    }
    return VarianceComponents{x.head(outputs_of(statistics)).array().exp(),
                              spread_prior(statistics, prior, x), std::move(*at)};
}

} // namespace dfdyn::tools
