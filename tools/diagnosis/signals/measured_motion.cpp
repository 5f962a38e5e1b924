// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/measured_motion.hpp"

#include "tools/base/numerics/quantum.hpp"
#include "tools/base/recording/columns_matrix.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/diagnosis/signals/cubic_weights.hpp"
#include "tools/diagnosis/signals/low_pass_kernel.hpp"
#include "tools/diagnosis/signals/position_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double highest_rate_hz = 130;

/// All signals of a segment on a uniform clock.
struct Resampled {
    Eigen::VectorXd time_s;
    Eigen::MatrixXd position, output;
};

Resampled resampled(const Recording& recording, const Stretch& stretch, double step) {
    const auto begin = static_cast<std::size_t>(stretch.first);
    const auto end = begin + static_cast<std::size_t>(stretch.count);
    const double start_s = recording.time_s[begin];
    const auto rows =
        static_cast<Eigen::Index>(std::floor((recording.time_s[end - 1] - start_s) / step + 1e-6)) + 1;
    const auto position = columns_matrix(recording.position);
    const auto output = columns_matrix(recording.output);
    Resampled result{Eigen::VectorXd(rows), Eigen::MatrixXd(rows, position.cols()),
                     Eigen::MatrixXd(rows, output.cols())};
    std::size_t next = begin;
    for (Eigen::Index row = 0; row < rows; ++row) {
        const double time_s = start_s + static_cast<double>(row) * step;
        while (next + 1 < end && recording.time_s[next] < time_s) {
            ++next;
        }
        const std::size_t first = std::clamp(next < begin + 2 ? begin : next - 2, begin, end - 4);
        const auto at = static_cast<Eigen::Index>(first);
        const Eigen::RowVector4d weights =
            cubic_weights(Eigen::Map<const Eigen::Vector4d>(&recording.time_s[first]), time_s);
        result.time_s[row] = time_s;
        result.position.row(row) = weights * position.middleRows(at, 4);
        result.output.row(row) = weights * output.middleRows(at, 4);
    }
    return result;
}

/// Returns the noise of the recording's positions; its segments are `stretches`.
PositionNoise noise_of(const Recording& recording, const std::vector<Resampled>& stretches, double rate_hz) {
    const auto positions = columns_matrix(recording.position);
    Eigen::VectorXd quantum(positions.cols());
    for (Eigen::Index joint = 0; joint < quantum.size(); ++joint) {
        const auto column = positions.col(joint);
        quantum[joint] = quantum_of({column.begin(), column.end()}).value_or(0);
    }
    std::vector<Eigen::MatrixXd> segments;
    for (const Resampled& stretch : stretches) {
        segments.push_back(stretch.position);
    }
    return position_noise(segments, quantum, rate_hz);
}

void append(MeasuredMotion& result, const Resampled& stretch, double rate_hz, Eigen::Index step) {
    const auto kernel_for = [&](double cutoff_hz) { return low_pass_kernel(cutoff_hz / rate_hz); };
    const Eigen::Index first = result.time_s.size();
    const Eigen::Index rows = (stretch.time_s.size() + step - 1) / step;
    const auto grow = [&](Eigen::MatrixXd& matrix, Eigen::Index columns) {
        matrix.conservativeResize(first + rows, columns);
    };
    RobotMotion& motion = result.motion;
    grow(motion.position, stretch.position.cols());
    grow(motion.velocity, stretch.position.cols());
    grow(motion.acceleration, stretch.position.cols());
    grow(result.outputs, stretch.output.cols());
    for (Eigen::Index joint = 0; joint < stretch.position.cols(); ++joint) {
        const Eigen::VectorXd smooth =
            filtered(stretch.position.col(joint), kernel_for(result.smoothing_hz[joint]));
        const Eigen::VectorXd velocity = differentiated(smooth) * rate_hz;
        const Eigen::VectorXd acceleration = differentiated(velocity) * rate_hz;
        const Eigen::VectorXi kept = Eigen::VectorXi::LinSpaced(rows, 0, static_cast<int>((rows - 1) * step));
        motion.position.col(joint).tail(rows) = smooth(kept);
        motion.velocity.col(joint).tail(rows) = velocity(kept);
        motion.acceleration.col(joint).tail(rows) = acceleration(kept);
    }
    for (Eigen::Index output = 0; output < stretch.output.cols(); ++output) {
        result.outputs.col(output).tail(rows) =
            step == 1 ? stretch.output.col(output)
                      : filtered(stretch.output.col(output), kernel_for(0.45 * result.rate_hz), step);
    }
    result.time_s.conservativeResize(first + rows);
    for (Eigen::Index row = 0; row < rows; ++row) {
        result.time_s[first + row] = stretch.time_s[row * step];
    }
    result.stretches.push_back({first, rows});
}

} // namespace

MeasuredMotion measured_motion(const Recording& recording) {
    const double step = median_step_s(recording);
    constexpr Eigen::Index fewest_rows = 4; // of the cubic interpolation
    std::vector<Resampled> stretches;
    for (const Stretch& stretch : recorded_stretches(recording)) {
        if (stretch.count >= fewest_rows &&
            static_cast<double>(stretch.count) * step >= MeasuredMotion::shortest_stretch_s) {
            stretches.push_back(resampled(recording, stretch, step));
        }
    }
    if (stretches.empty()) {
        throw InputError(recording.source + ": expected " + number_text(MeasuredMotion::shortest_stretch_s) +
                         " s and four rows without a gap, found less");
    }
    const double rate_hz = 1 / step;
    const PositionNoise noise = noise_of(recording, stretches, rate_hz);
    const auto decimation = std::max<Eigen::Index>(1, std::llround(std::ceil(rate_hz / highest_rate_hz)));
    MeasuredMotion result;
    result.rate_hz = rate_hz / static_cast<double>(decimation);
    result.smoothing_hz = noise.trusted_hz.cwiseMax(3.0).cwiseMin(0.3 * result.rate_hz);
    // white noise of variance s² per sample at `rate`, low-passed at f and differentiated: (2π)² s² · 2/rate
    // · f³/3
    result.velocity_noise =
        2 * std::numbers::pi *
        (2 * step / 3 * result.smoothing_hz.array().cube() * noise.power.array()).sqrt().matrix();
    for (const Resampled& stretch : stretches) {
        append(result, stretch, rate_hz, decimation);
    }
    return result;
}

} // namespace dfdyn::tools
