// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/output_error.hpp"

#include <cmath>

namespace dfdyn::tools {

void OutputError::add(double measured, double forecast) {
    if (std::isfinite(measured) && std::isfinite(forecast)) {
        count_ += 1;
        const double difference = measured - mean_;
        mean_ += difference / count_;
        variation_ += difference * (measured - mean_);
        error_square_ += (measured - forecast) * (measured - forecast);
    }
}

double OutputError::normalised() const { return std::sqrt(error_square_ / variation_); }

} // namespace dfdyn::tools
