// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/low_pass_kernel.hpp"

#include <cmath>
#include <numbers>

namespace dfdyn::tools {

Eigen::VectorXd low_pass_kernel(double cutoff) {
    constexpr double pi = std::numbers::pi;
    const Eigen::Index half = std::llround(std::ceil(2 / cutoff));
    Eigen::VectorXd kernel(2 * half + 1);
    for (Eigen::Index i = -half; i <= half; ++i) {
        const auto n = static_cast<double>(i);
        const double phase = pi * (n / static_cast<double>(half + 1) + 1);
        const double window = 0.42 - 0.5 * std::cos(phase) + 0.08 * std::cos(2 * phase);
        kernel[i + half] = window * (i == 0 ? 2 * cutoff : std::sin(2 * pi * cutoff * n) / (pi * n));
    }
    return kernel / kernel.sum();
}

Eigen::VectorXd filtered(const Eigen::Ref<const Eigen::VectorXd>& signal, const Eigen::VectorXd& kernel,
                         Eigen::Index step) {
    const Eigen::Index half = kernel.size() / 2;
    const Eigen::Index last = signal.size() - 1;
    Eigen::VectorXd padded(signal.size() + 2 * half);
    padded.segment(half, signal.size()) = signal;
    for (Eigen::Index i = 1; i <= half; ++i) {
        padded[half - i] = 2 * signal[0] - signal[std::min(i, last)];
        padded[half + last + i] = 2 * signal[last] - signal[std::max<Eigen::Index>(last - i, 0)];
    }
    Eigen::VectorXd result((signal.size() + step - 1) / step);
    for (Eigen::Index i = 0; i < result.size(); ++i) {
        result[i] = padded.segment(i * step, kernel.size()).dot(kernel);
    }
    return result;
}

Eigen::VectorXd differentiated(const Eigen::Ref<const Eigen::VectorXd>& signal) {
    const Eigen::Index count = signal.size();
    Eigen::VectorXd result = Eigen::VectorXd::Zero(count);
    if (count < 3) {
        return result;
    }
    result.segment(1, count - 2) = (signal.tail(count - 2) - signal.head(count - 2)) / 2;
    if (count > 4) {
        result.segment(2, count - 4) = (8 * (signal.segment(3, count - 4) - signal.segment(1, count - 4)) -
                                        (signal.tail(count - 4) - signal.head(count - 4))) /
                                       12;
    }
    result[0] = 2 * result[1] - result[2];
    result[count - 1] = 2 * result[count - 2] - result[count - 3];
    return result;
}

} // namespace dfdyn::tools
