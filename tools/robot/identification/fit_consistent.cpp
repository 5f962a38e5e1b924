// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/robot/identification/fit_parameters.hpp"
#include "tools/robot/identification/log_cholesky.hpp"
#include "tools/robot/regressor.hpp"

#include <Eigen/Core>
#include <unsupported/Eigen/LevenbergMarquardt>

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr int evaluations_most = 2000;
constexpr double least_mass_part = 1e-3; ///< of the whole arm's mass, for nominal bodies without mass
constexpr double least_size = 0.01;      ///< m

/// |data_factor π(θ) − data_target|² + |(θ − start) / spread|²: the objective of the Levenberg-Marquardt
/// method.
struct Problem : Eigen::DenseFunctor<double> {
    Eigen::MatrixXd data_factor; ///< p x p: triangular factor of the weighted regressor
    Eigen::VectorXd data_target;
    Eigen::VectorXd start, spread; ///< of the coordinates

    explicit Problem(Eigen::Index parameters)
        : DenseFunctor(static_cast<int>(parameters), static_cast<int>(2 * parameters)) {}

    Eigen::VectorXd parameters(const Eigen::VectorXd& theta) const {
        Eigen::VectorXd result(theta.size());
        for (Eigen::Index first = 0; first < theta.size(); first += 10) {
            result.segment<10>(first) = parameters_from(theta.segment<10>(first));
        }
        return result;
    }

    int operator()(const Eigen::VectorXd& theta, Eigen::VectorXd& residual) const {
        residual.head(theta.size()) = data_factor * parameters(theta) - data_target;
        residual.tail(theta.size()) = (theta - start).cwiseQuotient(spread);
        return residual.allFinite() ? 0 : -1;
    }

    int df(const Eigen::VectorXd& theta, Eigen::MatrixXd& slope) const {
        slope.setZero();
        for (Eigen::Index first = 0; first < theta.size(); first += 10) {
            slope.block(0, first, theta.size(), 10) =
                data_factor.middleCols<10>(first) * parameters_slope(theta.segment<10>(first));
        }
        slope.bottomRows(theta.size()).diagonal() = spread.cwiseInverse();
        return 0;
    }
};

/// Expected deviation of a body's coordinates from their start: e-folds, and its size in m.
LogCholesky expected_spread(const LogCholesky& start) {
    const double size = std::max(
        {std::exp(start[1]), std::exp(start[2]), std::exp(start[3]), start.tail<3>().norm(), least_size});
    LogCholesky spread = LogCholesky::Constant(size);
    spread.head<4>() << 0.5, 1, 1, 1; // mass is e^2α
    return spread;
}

void add_start(const Eigen::VectorXd& nominal, Problem& problem) {
    double mass = 0;
    for (Eigen::Index first = 0; first < nominal.size(); first += 10) {
        mass += std::max(nominal[first], 0.0);
    }
    const double least_mass = mass > 0 ? least_mass_part * mass : 1;
    problem.start.resize(nominal.size());
    problem.spread.resize(nominal.size());
    for (Eigen::Index first = 0; first < nominal.size(); first += 10) {
        const LogCholesky start = coordinates_of(made_consistent(nominal.segment<10>(first), least_mass));
        problem.start.segment<10>(first) = start;
        problem.spread.segment<10>(first) = expected_spread(start);
    }
}

/// Reduces the weighted samples to p equations.
void add_data(const FitData& data, const FitNoise& noise, Problem& problem) {
    const Eigen::VectorXd weight =
        (noise.deviation.array() * noise.correlation_length.array().sqrt()).inverse().matrix();
    const Eigen::VectorXd weights = weight.replicate(data.outputs.rows(), 1);
    const Eigen::Index p = data.regressor.cols();
    Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(std::max(data.regressor.rows(), p + 1), p + 1);
    equations.topLeftCorner(data.regressor.rows(), p) = weights.asDiagonal() * data.regressor;
    equations.col(p).head(data.regressor.rows()) = weights.cwiseProduct(stacked(data.outputs));
    const Eigen::MatrixXd r = triangular_factor(equations).topRows(p);
    problem.data_factor = r.leftCols(p);
    problem.data_target = r.col(p);
}

} // namespace

Eigen::VectorXd fit_consistent_parameters(const FitData& data, const FitNoise& noise) {
    Problem problem(data.nominal.size());
    add_start(data.nominal, problem);
    add_data(data, noise, problem);
    Eigen::LevenbergMarquardt<Problem> search(problem);
    search.setMaxfev(evaluations_most);
    Eigen::VectorXd theta = problem.start;
    search.minimize(theta);
    return problem.parameters(theta);
}

} // namespace dfdyn::tools
