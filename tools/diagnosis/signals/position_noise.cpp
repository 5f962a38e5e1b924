// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/position_noise.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/diagnosis/signals/lapped_transform.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dfdyn::tools {

namespace {

/// Power of the positions per bin (one column per joint), averaged over the frames of all segments. It is
/// computed from second differences, because the motion itself would leak into all bins, and divided by the
/// frequency response of the differences.
Eigen::MatrixXd position_power(const std::vector<Eigen::MatrixXd>& positions,
                               const LappedTransform& transform) {
    Eigen::MatrixXd power = Eigen::MatrixXd::Zero(transform.bins(), positions.front().cols());
    Eigen::Index frames = 0;
    for (const Eigen::MatrixXd& segment : positions) {
        const Eigen::Index rows = segment.rows() - 2;
        for (Eigen::Index joint = 0; joint < power.cols(); ++joint) {
            const Eigen::VectorXd position = segment.col(joint);
            const Eigen::VectorXd second =
                position.tail(rows) - 2 * position.segment(1, rows) + position.head(rows);
            power.col(joint) += transform.analyse(second).rowwise().squaredNorm();
        }
        frames += transform.frames(rows);
    }
    for (Eigen::Index bin = 0; bin < power.rows(); ++bin) {
        const double phase =
            std::numbers::pi * (static_cast<double>(bin) + 0.5) / static_cast<double>(transform.hop());
        power.row(bin) /= std::pow(2 * std::sin(phase / 2), 4);
    }
    return power / static_cast<double>(std::max<Eigen::Index>(frames, 1));
}

/// Variance of white noise with the level that an encoder's rounding has at low frequencies.
double rounding_power(const std::vector<Eigen::MatrixXd>& positions, Eigen::Index joint, double quantum,
                      double rate_hz) {
    constexpr double resting_s = 0.25; // a joint that keeps its reading for so long has no varying error
    const auto window = std::max<Eigen::Index>(1, std::llround(resting_s * rate_hz));
    double windows = 0;
    double moving = 0;
    double counts = 0;
    for (const Eigen::MatrixXd& segment : positions) {
        for (Eigen::Index first = 0; first + window < segment.rows(); first += window) {
            const auto part = segment.col(joint).segment(first, window + 1);
            const double travel = (part.tail(window) - part.head(window)).cwiseAbs().sum() / quantum;
            ++windows;
            moving += travel >= 0.5 ? 1 : 0;
            counts += travel;
        }
    }
    if (moving == 0) {
        return 0;
    }
    const double counts_per_row = counts / (moving * static_cast<double>(window));
    // the error of c counts per row has its power below about twice c, of the rows' band of one half
    const double concentrated = std::max(1.0, 0.25 / counts_per_row);
    return moving / windows * concentrated * quantum * quantum / 12;
}

} // namespace

PositionNoise position_noise(const std::vector<Eigen::MatrixXd>& positions, const Eigen::VectorXd& quantum,
                             double rate_hz) {
    const auto hop = std::max<Eigen::Index>(16, std::llround(rate_hz));
    const LappedTransform transform(hop, hop);
    const Eigen::MatrixXd power = position_power(positions, transform);
    const double bin_hz = rate_hz / (2 * static_cast<double>(hop));
    PositionNoise noise{Eigen::VectorXd(power.cols()), Eigen::VectorXd(power.cols())};
    for (Eigen::Index joint = 0; joint < power.cols(); ++joint) {
        const Eigen::VectorXd top = power.col(joint).tail(hop / 3);
        noise.power[joint] = median(std::vector<double>(top.begin(), top.end()));
        if (quantum[joint] > 0) {
            noise.power[joint] =
                std::max(noise.power[joint], rounding_power(positions, joint, quantum[joint], rate_hz));
        }
        const auto window = std::min<Eigen::Index>(hop / 4, std::llround(1.5 / bin_hz));
        Eigen::Index bin = 0;
        while (bin + window < hop && power.col(joint).segment(bin, window).mean() > 8 * noise.power[joint]) {
            ++bin;
        }
        noise.trusted_hz[joint] = static_cast<double>(bin) * bin_hz;
    }
    return noise;
}

} // namespace dfdyn::tools
