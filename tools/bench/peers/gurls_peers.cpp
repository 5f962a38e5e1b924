// SPDX-License-Identifier: Apache-2.0
// Reimplementation of the recursive Cholesky update of GURLS (https://github.com/LCSL/GURLS, the paper's
// tool; rlsprimalrecupdatecholesky.h, cholupdateutils.h, gmat2d.hpp). Compiled if BLAS is available at build
// time. GURLS itself is not in Debian.
#include "tools/bench/peers/typed_learner.hpp"

#ifdef DFDYN_HAS_BLAS

#include "tools/bench/peers/blas.hpp"

#include <cmath>

namespace dfdyn::tools {

namespace {

/// One Givens rotation per row of the upper factor of the information matrix, then two triangular solves. It
/// makes the same BLAS calls in the same memory order as GURLS, and the same copies of the factor, which goes
/// through a second buffer. It is a lower bound of the time of GURLS, because the remaining work per sample
/// (its list of options, copies of weights and right-hand sides) is left out.
class RecursiveCholesky final : public EigenLearner<double> {
  public:
    explicit RecursiveCholesky(const RegressionTask& task)
        : EigenLearner("GURLS' Cholesky update, stand-in", Kind::gurls, task),
          factor_(Matrix::Identity(columns(), columns()) / std::sqrt(RegressionTask::prior_variance)),
          right_(weights_), row_(columns()) {}

  private:
    void fold(const Row& row, const Outputs& targets, const Outputs& /*means*/) override {
        Matrix updated(factor_);
        rotate(updated, row);
        const Matrix passed(updated);
        keep(passed.data());
        updated = passed;
        factor_.swap(updated);
        right_.noalias() += row * targets.transpose();
        weights_ = right_;
        solve("T");
        solve("N");
    }

    /// Updates the factor with a row.
    void rotate(Matrix& factor, const Row& row) {
        row_ = row;
        const int one = 1;
        const int stride = columns();
        for (int i = 0; i < columns(); ++i) {
            double c = 0;
            double s = 0;
            drotg_(&factor(i, i), &row_(i), &c, &s);
            if (const int rest = columns() - i - 1; rest > 0) {
                drot_(&rest, &factor(i, i + 1), &stride, &row_(i + 1), &one, &c, &s);
            }
        }
    }

    void solve(const char* transposed) {
        const int size = columns();
        const int count = RegressionTask::outputs;
        const double unscaled = 1;
        dtrsm_("L", "U", transposed, "N", &size, &count, &unscaled, factor_.data(), &size, weights_.data(),
               &size);
    }

    Matrix factor_, right_;
    Vector row_;
};

} // namespace

std::string blas_name() { return openblas_get_config == nullptr ? "not OpenBLAS" : openblas_get_config(); }

void keep_blas_on_one_core() {
    if (openblas_set_num_threads != nullptr) {
        openblas_set_num_threads(1);
    }
}

const Peer gurls_peer{[](const RegressionTask& task) {
                          BenchLearners one;
                          one.push_back(std::make_unique<RecursiveCholesky>(task));
                          return one;
                      },
                      "GURLS (the paper's tool) is not in Debian and does not build with the present Boost. "
                      "Its stand-in makes the same BLAS calls for a sample, in the same memory order, and "
                      "the same copies of the factor. It does nothing else, so GURLS cannot be faster. "
                      "iCub's learningMachine is not measured here."};

} // namespace dfdyn::tools

#else

namespace dfdyn::tools {

std::string blas_name() { return "none"; }

void keep_blas_on_one_core() {}

const Peer gurls_peer{
    nullptr, "BLAS: not installed when this program was built (libopenblas-serial-dev). Without it the "
             "stand-in for GURLS, the paper's tool, is missing."};

} // namespace dfdyn::tools

#endif
