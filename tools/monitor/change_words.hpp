// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/monitor/monitored_estimator.hpp"

namespace dfdyn::tools {

/// Returns a change with the names and units of the arm.
NamedChange named(const Change<float, dynamic>& change, const MonitorSetup& setup);
NamedChange named(const Change<float, 6>& change, const MonitorSetup& setup);

} // namespace dfdyn::tools
