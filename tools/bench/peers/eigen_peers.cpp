// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/peers/typed_learner.hpp"

#include <Eigen/Cholesky>

namespace dfdyn::tools {

namespace {

/// Textbook recursive least squares with one triangle of the covariance matrix.
template <class Scalar>
class EigenCovariance final : public EigenLearner<Scalar> {
    using Base = EigenLearner<Scalar>;

  public:
    explicit EigenCovariance(const RegressionTask& task)
        : Base("Eigen covariance, symmetric", BenchLearner::Kind::covariance, task),
          covariance_(Base::Matrix::Identity(this->columns(), this->columns()) *
                      Scalar(RegressionTask::prior_variance)),
          gain_(this->columns()) {}

  private:
    void fold(const typename Base::Row& row, const typename Base::Outputs& targets,
              const typename Base::Outputs& means) override {
        gain_.noalias() = covariance_.template selfadjointView<Eigen::Lower>() * row;
        const Scalar ratio = 1 + row.dot(gain_);
        keep(ratio);
        covariance_.template selfadjointView<Eigen::Lower>().rankUpdate(gain_, -1 / ratio);
        this->weights_.noalias() += gain_ * ((targets - means) / ratio).transpose();
    }

    typename Base::Matrix covariance_;
    typename Base::Vector gain_;
};

/// The paper's method with Eigen: a rank-one update of the Cholesky factor of the information matrix, then
/// two triangular solves for the weights. It computes no variance, which would need another solve.
template <class Scalar>
class EigenCholesky final : public EigenLearner<Scalar> {
    using Base = EigenLearner<Scalar>;

  public:
    explicit EigenCholesky(const RegressionTask& task)
        : Base("Eigen LLT::rankUpdate and solves", BenchLearner::Kind::cholesky, task),
          factor_(typename Base::Matrix(Base::Matrix::Identity(this->columns(), this->columns()) /
                                        Scalar(RegressionTask::prior_variance))),
          right_(this->weights_) {}

  private:
    void fold(const typename Base::Row& row, const typename Base::Outputs& targets,
              const typename Base::Outputs& /*means*/) override {
        factor_.rankUpdate(row, 1);
        right_.noalias() += row * targets.transpose();
        this->weights_ = right_;
        factor_.solveInPlace(this->weights_);
    }

    Eigen::LLT<typename Base::Matrix> factor_;
    typename Base::Matrix right_;
};

} // namespace

const Peer eigen_peer{[](const RegressionTask& task) {
    BenchLearners all;
    all.push_back(std::make_unique<EigenCovariance<float>>(task));
    all.push_back(std::make_unique<EigenCovariance<double>>(task));
    all.push_back(std::make_unique<EigenCholesky<float>>(task));
    all.push_back(std::make_unique<EigenCholesky<double>>(task));
    return all;
}};

} // namespace dfdyn::tools
