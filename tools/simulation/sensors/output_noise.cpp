// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/sensors/output_noise.hpp"

#include "tools/base/text/error.hpp"
#include "tools/simulation/random_streams.hpp"

#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

namespace dfdyn::tools {

namespace {

std::vector<double> standardised(std::vector<double> series, std::size_t piece_rows) {
    if (series.empty()) {
        return series;
    }
    if (series.size() <= piece_rows) {
        throw InputError("noise series: expected more than " + std::to_string(piece_rows) +
                         " values, the rows of a piece, found " + std::to_string(series.size()));
    }
    const auto count = static_cast<double>(series.size());
    const double mean = std::accumulate(series.begin(), series.end(), 0.0) / count;
    double squares = 0;
    for (double& value : series) {
        value -= mean;
        squares += value * value;
    }
    if (!(squares > 0)) {
        throw InputError("noise series: expected values that differ, found a constant");
    }
    for (double& value : series) {
        value /= std::sqrt(squares / count);
    }
    return series;
}

} // namespace

UnitNoise::UnitNoise(const OutputNoiseModel& model, std::uint64_t seed, std::uint32_t channel)
    : coefficient_(model.coefficient), series_(standardised(model.series, model.piece_rows)),
      piece_rows_(model.piece_rows), overlap_rows_(model.piece_rows / 8),
      source_(seed, stream::output_noise + channel) {
    std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                           stream::output_noise + channel};
    engine_.seed(sequence);
    if (series_.empty()) {
        value_ = source_.next();
        return;
    }
    past_piece_ = start_of_piece();
    piece_ = start_of_piece();
    row_ = engine_() % (piece_rows_ - overlap_rows_);
}

std::size_t UnitNoise::start_of_piece() { return engine_() % (series_.size() - piece_rows_); }

/// Cross-fades overlapping pieces with constant power.
double UnitNoise::resampled() {
    const std::size_t stride = piece_rows_ - overlap_rows_;
    if (row_ == stride) {
        row_ = 0;
        past_piece_ = piece_;
        piece_ = start_of_piece();
    }
    const std::size_t row = row_++;
    if (row >= overlap_rows_) {
        return series_[piece_ + row];
    }
    const double angle = std::numbers::pi / 2 * static_cast<double>(row) / static_cast<double>(overlap_rows_);
    return std::sin(angle) * series_[piece_ + row] + std::cos(angle) * series_[past_piece_ + stride + row];
}

double UnitNoise::next() {
    if (!series_.empty()) {
        return resampled();
    }
    const double value = value_;
    value_ = coefficient_ * value_ + std::sqrt(1 - coefficient_ * coefficient_) * source_.next();
    return value;
}

OutputNoise::OutputNoise(const OutputNoiseModel& model, std::uint64_t seed) : model_(model) {
    std::uint32_t channel = 0;
    for (Eigen::Index i = 0; i < model.torque.size(); ++i) {
        joints_.emplace_back(model, seed, channel++);
    }
    for (channel = largest_simulated_chain; axes_.size() < 6; ++channel) {
        axes_.emplace_back(model, seed, channel);
    }
}

JointVector OutputNoise::torque() {
    JointVector result = model_.torque;
    for (Eigen::Index i = 0; i < result.size(); ++i) {
        result[i] *= joints_[static_cast<std::size_t>(i)].next();
    }
    return result;
}

Wrench OutputNoise::wrench() {
    Wrench result = model_.wrench;
    for (Eigen::Index i = 0; i < 6; ++i) {
        result[i] *= axes_[static_cast<std::size_t>(i)].next();
    }
    return result;
}

} // namespace dfdyn::tools
