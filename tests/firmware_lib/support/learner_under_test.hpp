// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/ud_covariance.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"

#include "tests/firmware_lib/support/regression.hpp"

#include <string_view>
#include <type_traits>
#include <vector>

namespace dfdyn::tests {

/// A precision of the learner, and its tolerance with respect to the batch solution.
template <class ScalarType>
struct LearnerKind {
    using Scalar = ScalarType;
    template <int p, int m>
    using Learner = UdCovariance<Scalar, p, m>;
    static constexpr double tolerance = std::is_same_v<Scalar, float> ? 1e-3 : 1e-9;
    static constexpr std::string_view name = std::is_same_v<Scalar, float> ? "U-D, float" : "U-D, double";
};

using UdFloat = LearnerKind<float>;
using UdDouble = LearnerKind<double>;

/// Initial state of a learner under test: weights, and the covariance P = U D U' (U full, with unit
/// diagonal).
struct Start {
    Eigen::MatrixXd weights;    ///< p × m
    Eigen::MatrixXd unit_upper; ///< p × p
    Eigen::VectorXd diagonal;   ///< p

    /// Zero weights and the covariance `variance` I.
    static Start prior(int columns, int outputs, double variance) {
        return {Eigen::MatrixXd::Zero(columns, outputs), Eigen::MatrixXd::Identity(columns, columns),
                Eigen::VectorXd::Constant(columns, variance)};
    }
};

/// A learner with its constants and an interface in double. `p` and `m` may be `dynamic`.
template <class Kind, int p = dynamic, int m = dynamic>
class LearnerUnderTest {
  public:
    using Scalar = typename Kind::Scalar;
    using Learner = typename Kind::template Learner<p, m>;

    /// Starts from the prior.
    LearnerUnderTest(int columns, int outputs, double prior_variance, double forgetting_factor)
        : LearnerUnderTest(Start::prior(columns, outputs, prior_variance), prior_variance,
                           forgetting_factor) {
        constants_.start = nullptr;
        learner_.reset();
    }

    /// Starts from `start`. `ceiling` is the variance of the prior, an upper bound of the variance of every
    /// parameter under forgetting.
    LearnerUnderTest(const Start& start, double ceiling, double forgetting_factor)
        : columns_(static_cast<int>(start.weights.rows())), outputs_(static_cast<int>(start.weights.cols())),
          start_(converted(start)), constants_{static_cast<Scalar>(ceiling),
                                               static_cast<Scalar>(forgetting_factor), &start_},
          learner_(constants_, extent<p>(columns_), extent<m>(outputs_)) {}

    LearnerUnderTest(const LearnerUnderTest&) = delete;
    LearnerUnderTest& operator=(const LearnerUnderTest&) = delete;

    [[nodiscard]] Learner& learner() { return learner_; }

    void begin(const Eigen::VectorXd& row, const Eigen::VectorXd& target) {
        learner_.begin(scalars(row).data(), scalars(target).data());
    }

    /// Learns a row whose targets have `noise_variance`, in units of their noise variance.
    void learn_noisy(const Eigen::VectorXd& row, const Eigen::VectorXd& target, double noise_variance) {
        learner_.begin(scalars(row).data(), scalars(target).data(), static_cast<Scalar>(noise_variance));
        advance(Budget::unlimited());
    }

    bool advance(Budget budget) { return learner_.advance(budget); }

    void learn(const Regression& regression) {
        for (int t = 0; t < regression.row_count(); ++t) {
            begin(regression.rows.row(t), regression.targets.row(t));
            advance(Budget::unlimited());
        }
    }

    [[nodiscard]] Eigen::MatrixXd weights() const {
        return Eigen::MatrixXd::NullaryExpr(columns_, outputs_, [&](Eigen::Index j, Eigen::Index k) {
            return static_cast<double>(learner_.weights(static_cast<int>(k))[j]);
        });
    }

    [[nodiscard]] Eigen::VectorXd parameter_variances() const {
        return Eigen::VectorXd::NullaryExpr(columns_, [&](Eigen::Index j) {
            return static_cast<double>(learner_.parameter_variance(static_cast<int>(j)));
        });
    }

    [[nodiscard]] Eigen::VectorXd means(const Eigen::VectorXd& row) const {
        std::vector<Scalar> means(static_cast<std::size_t>(outputs_));
        learner_.predict(scalars(row).data(), means.data());
        return Eigen::Map<const Eigen::Matrix<Scalar, Eigen::Dynamic, 1>>(means.data(), outputs_)
            .template cast<double>();
    }

    [[nodiscard]] double variance(const Eigen::VectorXd& row) const {
        return static_cast<double>(learner_.variance(scalars(row).data()));
    }

  private:
    using StartConstants = LearnerStart<Scalar, p, m>;

    static Eigen::Matrix<Scalar, Eigen::Dynamic, 1> scalars(const Eigen::VectorXd& vector) {
        return vector.cast<Scalar>();
    }

    static StartConstants converted(const Start& start) {
        const auto columns = static_cast<int>(start.weights.rows());
        const auto outputs = static_cast<int>(start.weights.cols());
        StartConstants result{Storage<Scalar, product(m, p)>::zeros(extent<product(m, p)>(outputs * columns)),
                              Storage<Scalar, StartConstants::upper_size(p)>::zeros(
                                  extent<StartConstants::upper_size(p)>(StartConstants::upper_size(columns))),
                              Storage<Scalar, p>::zeros(extent<p>(columns))};
        for (int j = 0; j < columns; ++j) {
            result.diagonal[j] = static_cast<Scalar>(start.diagonal[j]);
            for (int i = 0; i < j; ++i) {
                result.unit_upper[j * (j - 1) / 2 + i] = static_cast<Scalar>(start.unit_upper(i, j));
            }
            for (int k = 0; k < outputs; ++k) {
                result.weights[k * columns + j] = static_cast<Scalar>(start.weights(j, k));
            }
        }
        return result;
    }

    int columns_;
    int outputs_;
    StartConstants start_;
    LearnerConstants<Scalar, p, m> constants_;
    Learner learner_;
};

} // namespace dfdyn::tests
