// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/run_time/runtime_estimator.hpp"

#include <memory>

namespace dfdyn::tools {

/// Returns `estimator` with every budget replaced by Budget::predict_only(): it predicts and reports
/// innovations without learning. No measured output changes a later prediction.
std::unique_ptr<RuntimeEstimator> frozen(std::unique_ptr<RuntimeEstimator> estimator);

} // namespace dfdyn::tools
