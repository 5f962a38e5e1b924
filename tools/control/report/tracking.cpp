// SPDX-License-Identifier: Apache-2.0
#include "tools/control/report/tracking.hpp"

#include <cmath>

namespace dfdyn::tools {

void Tracking::add(double time_s, const JointVector& error, const JointVector& learned_share) {
    if (count_ == 0) {
        squares_ = shares_ = JointVector::Zero(error.size());
    }
    squares_ += error.cwiseAbs2();
    shares_ += learned_share;
    ++count_;
    const double end_s = static_cast<double>(windows_.size() + 1) * window_s_;
    const double rounding_s = 1e-6 * period_s_;
    if (time_s + period_s_ >= end_s - rounding_s) {
        close();
    }
}

void Tracking::close() {
    TrackingWindow window;
    window.start_s = static_cast<double>(windows_.size()) * window_s_;
    window.end_s = window.start_s + window_s_;
    const auto count = static_cast<double>(count_);
    window.rms = (squares_ / count).cwiseSqrt();
    window.all = std::sqrt(squares_.mean() / count);
    window.learned = shares_ / count;
    windows_.push_back(window);
    count_ = 0;
}

} // namespace dfdyn::tools
