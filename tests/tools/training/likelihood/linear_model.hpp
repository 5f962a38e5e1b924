// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/tools/training/numerics.hpp"
#include "tools/base/numerics/random_source.hpp"
#include "tools/training/likelihood/physics_likelihood.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <cmath>
#include <numbers>

namespace dfdyn::tests {

/// The model y_k = Psi_k pi + e_k with random columns and covariance, evaluated with dense matrices.
struct LinearModel {
    static constexpr Eigen::Index outputs = 3;
    static constexpr Eigen::Index columns = 4;

    tools::NormalSource random;
    Eigen::MatrixXd covariance; // C
    Eigen::MatrixXd psi;        // N x (m p)
    Eigen::MatrixXd y;          // N x m

    explicit LinearModel(std::uint64_t seed, Eigen::Index samples = 12) : random(seed) {
        const Eigen::MatrixXd root = random.matrix(samples, samples) / std::sqrt(samples);
        covariance = root * root.transpose() + Eigen::MatrixXd::Identity(samples, samples);
        psi = random.matrix(samples, outputs * columns);
        draw(Eigen::VectorXd::LinSpaced(outputs, -1, 1), 2.0);
    }

    /// Draws new outputs with these variances.
    void draw(const Eigen::VectorXd& log_variances, double prior_variance) {
        const Eigen::VectorXd pi = std::sqrt(prior_variance) * random.matrix(columns, 1);
        y = covariance.llt().matrixL() * random.matrix(psi.rows(), outputs);
        for (Eigen::Index k = 0; k < outputs; ++k) {
            y.col(k) = std::exp(log_variances[k] / 2) * y.col(k) + psi.middleCols(k * columns, columns) * pi;
        }
    }

    static Eigen::Index groups(tools::PhysicsPrior prior) {
        return prior == tools::PhysicsPrior::none ? 0 : prior == tools::PhysicsPrior::shared ? 1 : columns;
    }

    tools::LinearStatistics statistics() const {
        return tools::linear_statistics(y, psi, covariance.llt().solve(y), covariance.llt().solve(psi));
    }

    /// All columns, output by output; (N m) x p.
    Eigen::MatrixXd stacked_columns() const {
        Eigen::MatrixXd stacked(psi.rows() * outputs, columns);
        for (Eigen::Index k = 0; k < outputs; ++k) {
            stacked.middleRows(k * psi.rows(), psi.rows()) = psi.middleCols(k * columns, columns);
        }
        return stacked;
    }

    /// Block diagonal matrix of v_k C.
    Eigen::MatrixXd stacked_covariance(const Eigen::VectorXd& log_variances) const {
        const Eigen::Index samples = psi.rows();
        Eigen::MatrixXd stacked = Eigen::MatrixXd::Zero(samples * outputs, samples * outputs);
        for (Eigen::Index k = 0; k < outputs; ++k) {
            stacked.block(k * samples, k * samples, samples, samples) =
                std::exp(log_variances[k]) * covariance;
        }
        return stacked;
    }

    /// log p(y) by the textbook formula; without a prior, at the generalised least-squares estimate of pi.
    double log_density(tools::PhysicsPrior prior, const Eigen::VectorXd& x) const {
        Eigen::MatrixXd total = stacked_covariance(x.head(outputs));
        Eigen::VectorXd residual = y.reshaped();
        const Eigen::MatrixXd stacked = stacked_columns();
        if (prior == tools::PhysicsPrior::none) {
            const Eigen::MatrixXd solved = total.fullPivLu().solve(stacked);
            residual -=
                stacked * (stacked.transpose() * solved).fullPivLu().solve(solved.transpose() * residual);
        } else {
            Eigen::VectorXd variances = x.tail(groups(prior)).array().exp();
            variances = variances.replicate(columns / groups(prior), 1).eval();
            total += stacked * variances.asDiagonal() * stacked.transpose();
        }
        const Eigen::LLT<Eigen::MatrixXd> factor(total);
        return -0.5 * static_cast<double>(residual.size()) * std::log(2 * std::numbers::pi) -
               Eigen::MatrixXd(factor.matrixL()).diagonal().array().log().sum() -
               0.5 * residual.dot(factor.solve(residual));
    }
};

} // namespace dfdyn::tests
