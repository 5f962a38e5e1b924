// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/recorded_data.hpp"

#include "dfdyn/input/adaptive_window.hpp"
#include "tools/base/numerics/quantile.hpp"
#include "tools/base/recording/sample_grid.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace dfdyn::tools {

namespace {

Eigen::Index index(std::size_t value) { return static_cast<Eigen::Index>(value); }

void copy_row(std::span<const double> from, Eigen::MatrixXd& to, Eigen::Index row) {
    to.row(row) = Eigen::Map<const Eigen::RowVectorXd>(from.data(), index(from.size()));
}

std::vector<std::int64_t> sample_times_ns(std::span<const Recording> recordings) {
    std::vector<std::int64_t> times;
    for (const Recording& recording : recordings) {
        times.insert(times.end(), recording.time_ns.begin(), recording.time_ns.end());
    }
    return times;
}

} // namespace

TrainingData gather_training_data(std::span<const Recording> recordings) {
    TrainingData data;
    data.sample_period_s = sample_period_s(recordings);
    data.steady = steady_stride(recordings);
    data.output_names = recordings.front().output.names;
    const auto rows = index(total_rows(recordings));
    data.positions.resize(rows, index(recordings.front().joint_count()));
    data.outputs.resize(rows, index(data.output_names.size()));
    for (const Recording& recording : recordings) {
        const std::vector<std::uint8_t> restarts = window_restarts(recording, data.sample_period_s);
        for (std::size_t row = 0; row < recording.row_count(); ++row) {
            const auto sample = index(data.gap_before.size());
            copy_row(recording.position.row(row), data.positions, sample);
            copy_row(recording.output.row(row), data.outputs, sample);
            data.gap_before.push_back(row == 0 || restarts[row] != 0);
        }
    }
    return data;
}

void copy_derivatives(TrainingData& data, std::span<const Recording> recordings) {
    data.velocities.resizeLike(data.positions);
    data.accelerations.resizeLike(data.positions);
    Eigen::Index sample = 0;
    for (const Recording& recording : recordings) {
        for (std::size_t row = 0; row < recording.row_count(); ++row, ++sample) {
            copy_row(recording.velocity.row(row), data.velocities, sample);
            copy_row(recording.acceleration.row(row), data.accelerations, sample);
        }
    }
}

double estimate_position_noise_bound(const TrainingData& data) {
    constexpr double smallest = 1e-6;
    const double third_difference_gain = std::sqrt(20.0); // of white noise: 1 + 9 + 9 + 1
    double bound = smallest;
    for (Eigen::Index joint = 0; joint < data.positions.cols(); ++joint) {
        std::vector<double> magnitudes;
        const auto q = data.positions.col(joint);
        for (Eigen::Index t = 3; t < q.size(); ++t) {
            const double difference = std::abs(q[t] - 3 * q[t - 1] + 3 * q[t - 2] - q[t - 3]);
            if (difference > 0) {
                magnitudes.push_back(difference);
            }
        }
        if (!magnitudes.empty()) {
            bound = std::max(bound,
                             3 * median_to_deviation * median(std::move(magnitudes)) / third_difference_gain);
        }
    }
    return bound;
}

void estimate_derivatives(TrainingData& data, std::span<const Recording> recordings, int lags,
                          double position_noise_bound) {
    const std::vector<std::int64_t> times_ns = sample_times_ns(recordings);
    const Eigen::Index rows = data.positions.rows();
    data.velocities = Eigen::MatrixXd::Zero(rows, data.positions.cols());
    data.accelerations = data.velocities;
    std::vector<double> ages_s(static_cast<std::size_t>(lags) + 1);
    std::vector<double> values(ages_s.size());
    int filled = 0;
    for (Eigen::Index t = 0; t < rows; ++t) {
        filled = data.gap_before[static_cast<std::size_t>(t)] ? 1 : std::min(filled + 1, lags + 1);
        for (Eigen::Index joint = 0; joint < data.positions.cols(); ++joint) {
            std::size_t count = 0;
            for (int lag = 0; lag < filled; ++lag) {
                ages_s[count] = 1e-9 * static_cast<double>(times_ns[static_cast<std::size_t>(t - lag)] -
                                                           times_ns[static_cast<std::size_t>(t)]);
                values[count] = data.positions(t - lag, joint);
                ++count;
            }
            const AdaptiveWindow<double> window(ages_s.data(), values.data(), 1, static_cast<int>(count),
                                                position_noise_bound);
            data.velocities(t, joint) = window.velocity();
            data.accelerations(t, joint) = window.acceleration();
        }
    }
}

} // namespace dfdyn::tools
