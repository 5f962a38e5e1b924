// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/typed_contender.hpp"

#include <Eigen/Cholesky>

namespace dfdyn::tools {

namespace {

/// The textbook's recursion over the covariance, one triangle of it.
template <class Scalar>
class EigenCovariance final : public TypedContender<Scalar> {
    using Base = TypedContender<Scalar>;
    using Row = Eigen::Map<const typename Base::Vector>;

  public:
    explicit EigenCovariance(const RegressionTask& task)
        : Base("Eigen covariance, symmetric", Contender::Kind::covariance, task),
          covariance_(Base::Matrix::Identity(this->columns(), this->columns()) *
                      Scalar(RegressionTask::prior_variance)),
          weights_(Base::Matrix::Zero(this->columns(), RegressionTask::outputs)), gain_(this->columns()) {}

  private:
    void learn(const Scalar* row, const Scalar* targets) override {
        const Row h(row, this->columns());
        const Eigen::Map<const typename Base::Outputs> y(targets);
        const typename Base::Outputs means = weights_.transpose() * h;
        gain_.noalias() = covariance_.template selfadjointView<Eigen::Lower>() * h;
        const Scalar ratio = 1 + h.dot(gain_);
        keep(means);
        keep(ratio);
        covariance_.template selfadjointView<Eigen::Lower>().rankUpdate(gain_, -1 / ratio);
        weights_.noalias() += gain_ * ((y - means) / ratio).transpose();
    }
    void predict(const Scalar* row, Scalar* means) override {
        for (int k = 0; k < RegressionTask::outputs; ++k) {
            means[k] = weights_.col(k).dot(Row(row, this->columns()));
        }
    }

    typename Base::Matrix covariance_, weights_;
    typename Base::Vector gain_;
};

/// The paper's route with Eigen: rank-one update of the Cholesky factor of the information matrix, then two
/// triangular solves for the weights. It gives no variance: that would be one more solve.
template <class Scalar>
class EigenCholesky final : public TypedContender<Scalar> {
    using Base = TypedContender<Scalar>;
    using Row = Eigen::Map<const typename Base::Vector>;

  public:
    explicit EigenCholesky(const RegressionTask& task)
        : Base("Eigen LLT::rankUpdate and solves", Contender::Kind::cholesky, task),
          factor_(typename Base::Matrix(Base::Matrix::Identity(this->columns(), this->columns()) /
                                        Scalar(RegressionTask::prior_variance))),
          right_(Base::Matrix::Zero(this->columns(), RegressionTask::outputs)), weights_(right_) {}

  private:
    void learn(const Scalar* row, const Scalar* targets) override {
        const Row h(row, this->columns());
        const Eigen::Map<const typename Base::Outputs> y(targets);
        const typename Base::Outputs means = weights_.transpose() * h;
        keep(means);
        factor_.rankUpdate(h, 1);
        right_.noalias() += h * y.transpose();
        weights_ = right_;
        factor_.solveInPlace(weights_);
    }
    void predict(const Scalar* row, Scalar* means) override {
        for (int k = 0; k < RegressionTask::outputs; ++k) {
            means[k] = weights_.col(k).dot(Row(row, this->columns()));
        }
    }

    Eigen::LLT<typename Base::Matrix> factor_;
    typename Base::Matrix right_, weights_;
};

} // namespace

Contenders eigen_peers(const RegressionTask& task) {
    Contenders all;
    all.push_back(std::make_unique<EigenCovariance<float>>(task));
    all.push_back(std::make_unique<EigenCovariance<double>>(task));
    all.push_back(std::make_unique<EigenCholesky<float>>(task));
    all.push_back(std::make_unique<EigenCholesky<double>>(task));
    return all;
}

} // namespace dfdyn::tools
