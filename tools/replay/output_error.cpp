// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/output_error.hpp"

#include <cmath>
#include <limits>

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

double OutputError::normalised() const {
    const bool constant = count_ > 0 && variation_ == 0; // also if the forecast is exact
    return constant ? std::numeric_limits<double>::infinity() : std::sqrt(error_square_ / variation_);
}

} // namespace dfdyn::tools
