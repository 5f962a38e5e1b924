// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/run_time/host_estimator.hpp"

#include <memory>

namespace dfdyn::tools {

/// Returns `estimator` with every budget replaced by Budget::predict_only(): it predicts and reports
/// innovations without learning. No measured output changes a later prediction.
std::unique_ptr<HostEstimator> frozen(std::unique_ptr<HostEstimator> estimator);

} // namespace dfdyn::tools
