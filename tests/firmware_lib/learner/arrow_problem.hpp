// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/block_arrow.hpp"

#include "tests/firmware_lib/support/regression.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <vector>

namespace block_arrow_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

template <class Scalar>
using RowMajor = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// y_k = φ'w_k + ψ_k'π + e at N times.
struct ArrowProblem {
    int columns, parameters, outputs;
    double feature_variance = 20; ///< of each w
    double common_variance = 3;   ///< of each π
    double forgetting_factor = 1;
    MatrixXd phi;                           ///< N × columns
    std::vector<RowMajor<double>> psi = {}; ///< N of outputs × parameters
    MatrixXd targets = {};                  ///< N × outputs

    ArrowProblem(std::mt19937_64& engine, int instants, int column_count, int parameter_count,
                 int output_count)
        : columns(column_count), parameters(parameter_count), outputs(output_count),
          phi(random_regression(engine, {instants, columns, 1}, Columns::fourier_features).rows) {
        std::normal_distribution<double> normal;
        const auto draw = [&] { return static_cast<double>(static_cast<float>(normal(engine))); };
        const VectorXd common = VectorXd::NullaryExpr(parameters, draw);
        const MatrixXd weights = MatrixXd::NullaryExpr(columns, outputs, draw);
        targets.resize(instants, outputs);
        for (int t = 0; t < instants; ++t) {
            psi.emplace_back(RowMajor<double>::NullaryExpr(outputs, parameters, draw));
            psi.back().col(0).array() += phi(t, 0); // not orthogonal to the features
            targets.row(t) = (psi.back() * common).transpose() + phi.row(t) * weights;
            targets.row(t) += VectorXd::NullaryExpr(outputs, draw).transpose();
        }
        targets = targets.cast<float>().cast<double>();
        for (RowMajor<double>& rows : psi) {
            rows = rows.cast<float>().cast<double>();
        }
    }

    [[nodiscard]] int instants() const { return static_cast<int>(phi.rows()); }
    [[nodiscard]] int unknowns() const { return outputs * columns + parameters; }

    /// Returns the row of output k for all unknowns [w_1 … w_m, π].
    [[nodiscard]] VectorXd dense_row(int t, int k) const {
        VectorXd row = VectorXd::Zero(unknowns());
        row.segment(k * columns, columns) = phi.row(t);
        row.tail(parameters) = psi[static_cast<std::size_t>(t)].row(k);
        return row;
    }
};

/// Mean and covariance of all unknowns after the first `instants` samples, by the normal equations.
struct DenseSolution {
    VectorXd mean;
    MatrixXd covariance;

    DenseSolution(const ArrowProblem& problem, int instants) {
        const double lambda = problem.forgetting_factor;
        VectorXd precision(problem.unknowns());
        precision << VectorXd::Constant(problem.outputs * problem.columns, 1 / problem.feature_variance),
            VectorXd::Constant(problem.parameters, 1 / problem.common_variance);
        MatrixXd information = precision.asDiagonal();
        VectorXd right = VectorXd::Zero(problem.unknowns());
        for (int t = 0; t < instants; ++t) {
            for (int k = 0; k < problem.outputs; ++k) {
                const VectorXd row = problem.dense_row(t, k);
                information += row * row.transpose();
                right += row * problem.targets(t, k);
            }
            information *= lambda;
            right *= lambda;
        }
        const Eigen::LDLT<MatrixXd> factor(information);
        mean = factor.solve(right);
        covariance = factor.solve(MatrixXd::Identity(problem.unknowns(), problem.unknowns()));
    }
};

/// The learner with its constants and an interface in double.
template <class Scalar>
class Arrow {
  public:
    using Learner = BlockArrow<Scalar, dynamic, dynamic, dynamic>;

    explicit Arrow(const ArrowProblem& problem)
        : outputs_(problem.outputs), columns_(problem.columns),
          // Starts far below the ceiling of variances, which has its own test.
          constants_{{ceiling, static_cast<Scalar>(problem.forgetting_factor), &feature_start_},
                     {ceiling, static_cast<Scalar>(problem.forgetting_factor), &common_start_}},
          feature_start_(prior<decltype(feature_start_)>(
              problem.columns, problem.outputs * (1 + problem.parameters), problem.feature_variance)),
          common_start_(prior<decltype(common_start_)>(problem.parameters, 1, problem.common_variance)),
          learner_(constants_, {problem.columns}, {problem.parameters}, {problem.outputs}) {}

    Arrow(const Arrow&) = delete;
    Arrow& operator=(const Arrow&) = delete;

    VectorXd predict(const ArrowProblem& problem, int t) {
        const Instant instant(problem, t);
        Values means(outputs_);
        learner_.predict(instant.phi.data(), instant.psi.data(), means.data());
        return means.template cast<double>();
    }

    VectorXd variances(const ArrowProblem& problem, int t) const {
        Values result(outputs_);
        learner_.variances(Instant(problem, t).phi.data(), result.data());
        return result.template cast<double>();
    }

    void begin(const ArrowProblem& problem, int t, double noise_variance = 1) {
        const Instant instant(problem, t);
        const Values targets = problem.targets.row(t).transpose().cast<Scalar>();
        learner_.begin(instant.phi.data(), instant.psi.data(), targets.data(),
                       static_cast<Scalar>(noise_variance));
    }

    void learn(const ArrowProblem& problem, int t, double noise_variance = 1) {
        predict(problem, t);
        begin(problem, t, noise_variance);
        Budget budget = Budget::unlimited();
        learner_.advance(budget);
    }

    [[nodiscard]] VectorXd all_unknowns() const {
        Values weights(outputs_ * columns_);
        learner_.copy_weights(weights.data());
        const auto parameters = static_cast<Index>(common_start_.diagonal.size());
        VectorXd result(weights.size() + parameters);
        result << weights.template cast<double>(),
            Eigen::Map<const Values>(learner_.common().parameters(), parameters).template cast<double>();
        return result;
    }

    Learner& learner() { return learner_; }

    static constexpr Scalar ceiling = 1000;

  private:
    using Values = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;

    struct Instant {
        Values phi;
        RowMajor<Scalar> psi;
        Instant(const ArrowProblem& problem, int t)
            : phi(problem.phi.row(t).transpose().cast<Scalar>()),
              psi(problem.psi[static_cast<std::size_t>(t)].cast<Scalar>()) {}
    };

    template <class Start>
    static Start prior(int columns, int outputs, double variance) {
        using Numbers = Storage<Scalar, dynamic>;
        Start start{Numbers::zeros({outputs * columns}), Numbers::zeros({columns * (columns - 1) / 2}),
                    Numbers::zeros({columns})};
        std::ranges::fill(start.diagonal, static_cast<Scalar>(variance));
        return start;
    }

    int outputs_;
    int columns_;
    BlockArrowConstants<Scalar, dynamic, dynamic, dynamic> constants_;
    LearnerStart<Scalar, dynamic, dynamic> feature_start_;
    LearnerStart<Scalar, dynamic, 1> common_start_;
    Learner learner_;
};

} // namespace block_arrow_test
