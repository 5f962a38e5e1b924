// SPDX-License-Identifier: Apache-2.0
// The Cholesky method with Fortran libraries, compiled if qrupdate, LAPACK and BLAS are available at build
// time.
#include "tools/bench/peers/typed_learner.hpp"

#ifdef DFDYN_HAS_QRUPDATE

#include "tools/bench/peers/blas.hpp"

extern "C" { // Fortran's names
// NOLINTBEGIN(readability-identifier-naming)
void sch1up_(const int* n, float* r, const int* ldr, float* u, float* w);
void dch1up_(const int* n, double* r, const int* ldr, double* u, double* w);
// NOLINTEND(readability-identifier-naming)
}

namespace dfdyn::tools {

namespace {

void update(const int& n, float* r, float* u, float* w) { sch1up_(&n, r, &n, u, w); }
void update(const int& n, double* r, double* u, double* w) { dch1up_(&n, r, &n, u, w); }

void solve(const int& n, const int& count, const float* r, float* b) {
    int info = 0;
    spotrs_("U", &n, &count, r, &n, b, &n, &info);
}
void solve(const int& n, const int& count, const double* r, double* b) {
    int info = 0;
    dpotrs_("U", &n, &count, r, &n, b, &n, &info);
}

template <class Scalar>
class Qrupdate final : public EigenLearner<Scalar> {
    using Base = EigenLearner<Scalar>;

  public:
    explicit Qrupdate(const RegressionTask& task)
        : Base("qrupdate ch1up and LAPACK potrs", BenchLearner::Kind::other, task),
          factor_(Base::Matrix::Identity(this->columns(), this->columns()) /
                  std::sqrt(Scalar(RegressionTask::prior_variance))),
          right_(this->weights_), row_(this->columns()), work_(this->columns()) {}

  private:
    void fold(const typename Base::Row& row, const typename Base::Outputs& targets,
              const typename Base::Outputs& /*means*/) override {
        row_ = row;
        right_.noalias() += row * targets.transpose();
        update(this->columns(), factor_.data(), row_.data(), work_.data());
        this->weights_ = right_;
        solve(this->columns(), RegressionTask::outputs, factor_.data(), this->weights_.data());
    }

    typename Base::Matrix factor_, right_;
    typename Base::Vector row_, work_;
};

} // namespace

const Peer qrupdate_peer{[](const RegressionTask& task) {
    BenchLearners both;
    both.push_back(std::make_unique<Qrupdate<float>>(task));
    both.push_back(std::make_unique<Qrupdate<double>>(task));
    return both;
}};

} // namespace dfdyn::tools

#else

namespace dfdyn::tools {

const Peer qrupdate_peer{nullptr, "qrupdate: not installed when this program was built (libqrupdate-dev)."};

} // namespace dfdyn::tools

#endif
