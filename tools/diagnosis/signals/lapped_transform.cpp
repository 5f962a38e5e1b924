// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/lapped_transform.hpp"

#include <cmath>
#include <numbers>

namespace dfdyn::tools {

LappedTransform::LappedTransform(Eigen::Index hop, Eigen::Index bins)
    : hop_(hop), basis_(bins, 2 * hop), window_squares_(2 * hop) {
    constexpr double pi = std::numbers::pi;
    const auto size = static_cast<double>(hop);
    for (Eigen::Index n = 0; n < 2 * hop; ++n) {
        const double time = static_cast<double>(n) + 0.5;
        const double sine = std::sin(pi * time / (2 * size));
        const double window = std::sqrt(2 / size) * std::sin(pi / 2 * sine * sine);
        window_squares_[n] = window * window / 2;
        for (Eigen::Index k = 0; k < bins; ++k) {
            basis_(k, n) = window * std::cos(pi / size * (time + size / 2) * (static_cast<double>(k) + 0.5));
        }
    }
}

Eigen::MatrixXd LappedTransform::analyse(const Eigen::Ref<const Eigen::VectorXd>& signal) const {
    const Eigen::Index count = frames(signal.size());
    // frame i starts at sample i · hop: a matrix whose columns overlap by half
    const Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>> overlapping(
        signal.data(), 2 * hop_, count, Eigen::OuterStride<>(hop_));
    return basis_ * overlapping;
}

Eigen::VectorXd LappedTransform::synthesise(const Eigen::Ref<const Eigen::MatrixXd>& coefficients,
                                            Eigen::Index samples) const {
    Eigen::VectorXd signal = Eigen::VectorXd::Zero(samples);
    for (Eigen::Index frame = 0; frame < coefficients.cols(); ++frame) {
        signal.segment(frame * hop_, 2 * hop_).noalias() += basis_.transpose() * coefficients.col(frame);
    }
    return signal;
}

} // namespace dfdyn::tools
