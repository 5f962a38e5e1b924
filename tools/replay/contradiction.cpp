// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/contradiction.hpp"
#include "tools/base/numerics/quantile.hpp"
#include "tools/replay/recorded_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr double merged_below_s = 0.25;
constexpr double margin = 3;
constexpr double ordinary_share = 0.999;
constexpr double normal_quantile = 3.0902; // of ordinary_share
constexpr double patience_s = 1.5;         // a contact of 1 s, and other contradictions shortly before
constexpr double no_limit = 1e30;

/// Learns the rows from `first` to `last`, counted over all recordings, and returns their innovations.
std::vector<double> learn_rows(RuntimeEstimator& estimator, std::span<const Recording> recordings,
                               std::size_t first, std::size_t last) {
    std::vector<double> innovations;
    tick_rows(estimator, recordings, first, last, Budget::unlimited(),
              [&innovations](const MeasuredSample&, const Tick& tick, bool) {
                  if (tick.status.estimated()) {
                      innovations.push_back(static_cast<double>(tick.normalised_innovation_squared));
                  }
              });
    return innovations;
}

/// Splits the rows of all recordings into two halves, and returns the innovations of each half for an
/// estimator that has learned the other half.
std::array<std::vector<double>, 2>
innovations_of_halves(const TrainedModel& model, std::span<const Recording> recordings, bool from_prior) {
    const std::size_t rows = total_rows(recordings);
    const auto later = make_estimator(model, from_prior);
    learn_rows(*later, recordings, 0, rows / 2);
    const auto earlier = make_estimator(model, from_prior);
    learn_rows(*earlier, recordings, rows / 2, rows);
    return {learn_rows(*earlier, recordings, 0, rows / 2), learn_rows(*later, recordings, rows / 2, rows)};
}

} // namespace

std::vector<Contradiction> find_contradictions(const ReplayedRecording& replayed, double limit) {
    std::vector<Contradiction> found;
    for (std::size_t tick = 0; tick < replayed.time_s.size(); ++tick) {
        const auto innovation = static_cast<double>(replayed.normalised_innovation_squared[tick]);
        if (!(innovation > limit)) {
            continue;
        }
        const double t = replayed.time_s[tick];
        if (found.empty() || t - found.back().end_s > merged_below_s) {
            found.push_back({t, t, innovation});
        } else {
            found.back().end_s = t;
            found.back().peak = std::max(found.back().peak, innovation);
        }
    }
    std::erase_if(found, [](const Contradiction& one) { return one.end_s <= one.start_s; });
    return found;
}

void calibrate_innovation_limit(TrainedModel& model, std::span<const Recording> recordings, bool from_prior) {
    model.limits.innovation = no_limit; // while the innovations are measured
    model.limits.innovation_patience = static_cast<int>(std::ceil(patience_s / model.sample_period_s));
    const std::size_t outputs = model.outputs.names.size();
    double ordinary = static_cast<double>(outputs) * mean_square_quantile(outputs, normal_quantile);
    for (const std::vector<double>& half : innovations_of_halves(model, recordings, from_prior)) {
        ordinary = half.empty() ? no_limit : std::max(ordinary, quantile(half, ordinary_share));
    }
    model.limits.innovation = std::min(margin * ordinary, no_limit);
}

} // namespace dfdyn::tools
