// SPDX-License-Identifier: Apache-2.0
// dlib's recursive least squares, compiled if dlib's headers are available at build time.
#include "tools/bench/peers/typed_learner.hpp"

#ifdef DFDYN_HAS_DLIB

#include <dlib/svm/rls.h>

namespace dfdyn::tools {

namespace {

/// It has one output; six instances are used, as in an application.
class DlibRls final : public TypedLearner<double> {
  public:
    explicit DlibRls(const RegressionTask& task)
        : TypedLearner("dlib::rls x 6", BenchLearner::Kind::other, task),
          learners_(RegressionTask::outputs, dlib::rls(1, RegressionTask::prior_variance)) {}

  private:
    void learn(const double* row, const double* targets) override {
        const auto h = dlib::mat(row, columns());
        for (dlib::rls& learner : learners_) {
            if (learner.get_w().size() > 0) {
                keep(learner(h));
            }
            learner.train(h, *targets++);
        }
    }
    void predict(const double* row, double* means) override {
        for (const dlib::rls& learner : learners_) {
            *means++ = learner(dlib::mat(row, columns()));
        }
    }

    std::vector<dlib::rls> learners_;
};

} // namespace

const Peer dlib_peer{[](const RegressionTask& task) {
    BenchLearners one;
    if (task.columns() <= 500) { // larger sizes take many milliseconds per tick
        one.push_back(std::make_unique<DlibRls>(task));
    }
    return one;
}};

} // namespace dfdyn::tools

#else

namespace dfdyn::tools {

const Peer dlib_peer{nullptr, "dlib: not installed when this program was built (libdlib-dev)."};

} // namespace dfdyn::tools

#endif
