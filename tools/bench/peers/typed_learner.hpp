// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/peers/bench_learner.hpp"
#include "tools/bench/timing/keep.hpp"

#include <algorithm>
#include <iterator>
#include <type_traits>

namespace dfdyn::tools {

/// A learner in one scalar type: the task converted to it, and the rows in turn.
template <class Scalar>
class TypedLearner : public BenchLearner {
  public:
    using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
    using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
    using Outputs = Eigen::Matrix<Scalar, RegressionTask::outputs, 1>;

    TypedLearner(std::string name, Kind kind, const RegressionTask& task)
        : BenchLearner(std::move(name), std::is_same_v<Scalar, float> ? "float" : "double", kind),
          rows_(task.rows().transpose().cast<Scalar>()), targets_(task.targets().transpose().cast<Scalar>()) {
    }

    void tick() final {
        learn(rows_.col(next_).data(), targets_.col(next_).data());
        next_ = next_ + 1 < rows_.cols() ? next_ + 1 : 0;
    }

    RegressionTask::Matrix predictions() final {
        RegressionTask::Matrix all(rows_.cols(), RegressionTask::outputs);
        for (Eigen::Index i = 0; i < rows_.cols(); ++i) {
            Scalar means[RegressionTask::outputs];
            predict(rows_.col(i).data(), means);
            std::copy(std::begin(means), std::end(means), all.row(i).data());
        }
        return all;
    }

  protected:
    int columns() const { return static_cast<int>(rows_.rows()); }

    /// Runs one tick with this row and its targets.
    virtual void learn(const Scalar* row, const Scalar* targets) = 0;
    virtual void predict(const Scalar* row, Scalar* means) = 0;

  private:
    Matrix rows_, targets_; ///< one sample per column
    Eigen::Index next_ = 0;
};

/// A learner whose weights, initially zero, are in an Eigen matrix with one column per output.
template <class Scalar>
class EigenLearner : public TypedLearner<Scalar> {
  public:
    using typename TypedLearner<Scalar>::Matrix;
    using typename TypedLearner<Scalar>::Vector;
    using typename TypedLearner<Scalar>::Outputs;
    using Row = Eigen::Map<const Vector>;

    EigenLearner(std::string name, BenchLearner::Kind kind, const RegressionTask& task)
        : TypedLearner<Scalar>(std::move(name), kind, task),
          weights_(Matrix::Zero(task.columns(), RegressionTask::outputs)) {}

  protected:
    /// Updates the learner with a row and its outputs, whose predictions were `means`.
    virtual void fold(const Row& row, const Outputs& targets, const Outputs& means) = 0;

    Matrix weights_;

  private:
    void learn(const Scalar* row, const Scalar* targets) final {
        const Row h(row, this->columns());
        const Outputs means = weights_.transpose() * h;
        keep(means);
        fold(h, Eigen::Map<const Outputs>(targets), means);
    }
    void predict(const Scalar* row, Scalar* means) final {
        Eigen::Map<Outputs>{means} = weights_.transpose() * Row(row, this->columns());
    }
};

} // namespace dfdyn::tools
