// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/timing/interleaved.hpp"
#include "tools/bench/timing/regression_task.hpp"

#include <memory>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A learner of six outputs with common columns. One tick predicts all outputs for the next row, updates the
/// learner with the row, and computes the weights for the following prediction.
class BenchLearner : public Ticking {
  public:
    enum class Kind { ours, covariance, cholesky, gurls, other };

    BenchLearner(std::string name, std::string scalar, Kind kind)
        : name_(std::move(name)), scalar_(std::move(scalar)), kind_(kind) {}

    const std::string& name() const noexcept { return name_; }
    const std::string& scalar() const noexcept { return scalar_; } ///< float or double
    Kind kind() const noexcept { return kind_; }

    /// Predictions for all distinct rows with the current weights.
    virtual RegressionTask::Matrix predictions() = 0;

  private:
    std::string name_, scalar_;
    Kind kind_;
};

using BenchLearners = std::vector<std::unique_ptr<BenchLearner>>;

/// Returns the firmware's learner with sizes known at compile time: 100, 200, 500, 1000 in float and double,
/// 2000 in float.
BenchLearners dfdyn_learners(const RegressionTask& task);

/// Returns the alternative learners that were available when this program was built.
BenchLearners peers(const RegressionTask& task);

/// Returns one line about each learner that is not measured, and the reason.
std::vector<std::string> missing_peers();

/// Returns the sizes of `dfdyn_learners`.
const std::vector<int>& learner_columns();

/// A library whose learners are compared with ours. To add one: a file with this object, and a line in
/// peers.cpp.
struct Peer {
    /// Returns its learners for the task; null if the library was not available when this program was built.
    BenchLearners (*make)(const RegressionTask& task);
    /// Missing measurement and its reason; null if nothing is missing.
    const char* missing = nullptr;
};

extern const Peer eigen_peer;
extern const Peer gurls_peer;
extern const Peer qrupdate_peer;
extern const Peer dlib_peer;

std::string blas_name();      ///< as far as it can be determined; "none" without BLAS
void keep_blas_on_one_core(); ///< like all learners under test, if the BLAS supports it

} // namespace dfdyn::tools
