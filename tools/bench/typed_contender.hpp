// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/contender.hpp"

#include <algorithm>
#include <iterator>
#include <type_traits>

namespace dfdyn::tools {

/// A contender in one scalar: the task in it, and the row in turn.
template <class Scalar>
class TypedContender : public Contender {
  public:
    using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
    using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
    using Outputs = Eigen::Matrix<Scalar, RegressionTask::outputs, 1>;

    TypedContender(std::string name, Kind kind, const RegressionTask& task)
        : Contender(std::move(name), std::is_same_v<Scalar, float> ? "float" : "double", kind),
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

    /// One tick with this row and its targets.
    virtual void learn(const Scalar* row, const Scalar* targets) = 0;
    virtual void predict(const Scalar* row, Scalar* means) = 0;

  private:
    Matrix rows_, targets_; ///< one sample per column
    Eigen::Index next_ = 0;
};

/// Where results go that nobody reads, so that they are computed.
template <class Value>
void keep(const Value& value) {
    asm volatile("" : : "r"(&value) : "memory");
}

} // namespace dfdyn::tools
