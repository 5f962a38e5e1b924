// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/run_time/host_estimator.hpp"

#include <memory>

namespace dfdyn::tools {

/// Returns `estimator` with every budget replaced by Budget::predict_only(): it predicts and reports
/// innovations, and learns nothing. No measured output changes any later prediction.
std::unique_ptr<HostEstimator> frozen(std::unique_ptr<HostEstimator> estimator);

} // namespace dfdyn::tools
