// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/lag_spacing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Returns, for each sample, the number of samples since the last gap, including the sample itself.
std::vector<int> samples_since_gap(const TrainingData& data) {
    std::vector<int> result(data.gap_before.size());
    for (std::size_t t = 0; t < result.size(); ++t) {
        result[t] = data.gap_before[t] != 0 || t == 0 ? 1 : result[t - 1] + 1;
    }
    return result;
}

} // namespace

LagSpacing spacing_of(double window_s, double period_s, int most_lags) {
    const double samples = std::max(1.0, std::round(window_s / period_s));
    const double every = std::max(1.0, std::ceil(samples / most_lags));
    return {std::max(least_window_lags, static_cast<int>(std::round(samples / every))),
            static_cast<int>(every)};
}

TrainingData spaced_data(const TrainingData& data, int every) {
    if (every == 1) {
        return data;
    }
    const std::vector<int> run = samples_since_gap(data);
    TrainingData spaced;
    spaced.output_names = data.output_names;
    spaced.steady = data.steady;
    spaced.sample_period_s = every * data.sample_period_s;
    spaced.positions.resize(data.positions.rows(), data.positions.cols());
    spaced.outputs.resize(data.outputs.rows(), data.outputs.cols());
    Index row = 0;
    for (Index phase = 0; phase < every; ++phase) {
        bool follows = false;
        for (Index t = phase; t < data.positions.rows(); t += every) {
            const int since = run[static_cast<std::size_t>(t)];
            if (since < every) {
                follows = false;
                continue;
            }
            spaced.positions.row(row) = data.positions.middleRows(t - every + 1, every).colwise().mean();
            spaced.outputs.row(row) = data.outputs.row(t);
            spaced.time_order.push_back(t);
            spaced.gap_before.push_back(follows && since >= 2 * every ? 0 : 1);
            follows = true;
            ++row;
        }
    }
    spaced.positions.conservativeResize(row, Eigen::NoChange);
    spaced.outputs.conservativeResize(row, Eigen::NoChange);
    return spaced;
}

MatrixXd dense_rows(const MatrixXd& rows, int every) {
    MatrixXd dense(rows.rows(), rows.cols() * every);
    for (Index lag = 0; lag < dense.cols(); ++lag) {
        dense.col(lag) = rows.col(lag / every) / every;
    }
    return dense;
}

InputModel dense_input(InputModel input, int every) {
    if (every == 1) {
        return input;
    }
    const Eigen::Map<const RowMajor> rows(input.rows.data(), input.rows_per_joint, input.lags + 1);
    const RowMajor dense = dense_rows(rows, every);
    input.rows.assign(dense.data(), dense.data() + dense.size());
    input.kind = InputKind::DFR;
    input.lags = static_cast<int>(dense.cols()) - 1;
    input.alpha = input.beta = {};
    return input;
}

} // namespace dfdyn::tools
