// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/opponents/opponents.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr double prior_variance = 1e6;

/// Recursive least squares of one output on its last two values and a constant.
class Autoregression {
  public:
    double forecast() const { return count_ < 2 ? last_[0] : coefficients_.dot(last_); }

    void learn(double value) {
        if (count_ >= 2) {
            const Eigen::Vector3d gain = covariance_ * last_ / (1 + last_.dot(covariance_ * last_));
            coefficients_ += gain * (value - coefficients_.dot(last_));
            covariance_ -= gain * (covariance_ * last_).transpose();
        }
        last_ = {value, last_[0], 1};
        count_ = std::min(count_ + 1, 2);
    }

  private:
    int count_ = 0; ///< values so far, at most 2
    Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d coefficients_ = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance_ = Eigen::Matrix3d::Identity() * prior_variance;
};

} // namespace

Forecasts autoregression(const ReplayedRecording& replayed, std::size_t outputs) {
    Forecasts forecasts(replayed.measured.size());
    std::vector<Autoregression> of_output(outputs);
    for (std::size_t element = 0; element < forecasts.size(); ++element) {
        Autoregression& one = of_output[element % outputs];
        forecasts[element] = one.forecast();
        if (std::isfinite(replayed.measured[element])) {
            one.learn(replayed.measured[element]);
        }
    }
    return forecasts;
}

} // namespace dfdyn::tools
