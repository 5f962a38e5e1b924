// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/replay.hpp"

#include "tools/common/error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn::tools {

namespace {

constexpr float not_predicted = std::numeric_limits<float>::quiet_NaN();

void check_fit(const TrainedModel& model, const Recording& recording) {
    const auto joints = static_cast<std::size_t>(model.joints);
    if (recording.joint_count() != joints) {
        throw InputError(recording.source + ": expected positions of " + std::to_string(joints) +
                         " joints as the model has, found " + std::to_string(recording.joint_count()));
    }
    if (recording.output.names != model.outputs.names) {
        throw InputError(recording.source + ": its outputs are not those of the model");
    }
}

void append(const Tick& tick, ReplayedRecording& replayed) {
    const bool predicted = tick.status.predicted();
    for (std::size_t k = 0; k < tick.prediction.size(); ++k) {
        replayed.predicted.push_back(predicted ? tick.prediction[k] : not_predicted);
        replayed.standard_deviation.push_back(predicted ? tick.standard_deviation[k] : not_predicted);
    }
    replayed.normalised_innovation_squared.push_back(predicted ? tick.normalised_innovation_squared
                                                               : not_predicted);
    replayed.status.push_back(tick.status);
    replayed.duration_us.push_back(std::chrono::duration<double, std::micro>(tick.duration).count());
}

} // namespace

ReplayedRecording replay(HostEstimator& estimator, const TrainedModel& model, const Recording& recording,
                         std::size_t horizon, const std::function<void(std::size_t)>& on_tick) {
    check_fit(model, recording);
    const std::size_t outputs = model.outputs.names.size();
    HorizonError errors(std::max<std::size_t>(horizon, 1), outputs, model.start.weights.size());
    ReplayedRecording replayed{
        recording.source, recording.time_s, recording.output.values, {}, {}, {}, {}, {}, {}};
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        if (recording.gap_before[row] != 0) {
            estimator.begin_recording();
        }
        const Tick tick =
            estimator.tick(recording.time_ns[row], recording.position.row(row), recording.output.row(row));
        append(tick, replayed);
        if (!tick.status.predicted()) {
            errors.skip();
        } else if (horizon > 0) {
            errors.add(estimator, recording.output.row(row));
        }
        on_tick(row + 1);
    }
    replayed.horizon = errors.indices();
    return replayed;
}

double normalised_error(const ReplayedRecording& replayed, std::size_t outputs, std::size_t output,
                        std::size_t first, std::size_t last) {
    double count = 0;
    double error_square = 0;
    double sum = 0;
    double square = 0;
    for (std::size_t tick = first; tick < last; ++tick) {
        const double measured = replayed.measured[tick * outputs + output];
        const auto predicted = static_cast<double>(replayed.predicted[tick * outputs + output]);
        if (std::isnan(predicted)) {
            continue;
        }
        count += 1;
        error_square += (measured - predicted) * (measured - predicted);
        sum += measured;
        square += measured * measured;
    }
    return count > 0 ? std::sqrt(error_square / (square - sum * sum / count))
                     : std::numeric_limits<double>::quiet_NaN();
}

double median_horizon_index(const ReplayedRecording& replayed, std::size_t output, double from_s,
                            double to_s) {
    std::vector<double> values;
    for (const HorizonIndex& index : replayed.horizon) {
        const double t = replayed.time_s[index.tick] - replayed.time_s.front();
        if (t >= from_s && t < to_s) {
            values.push_back(index.epsilon[output]);
        }
    }
    return values.empty() ? std::numeric_limits<double>::quiet_NaN() : quantile_of(std::move(values), 0.5);
}

double quantile_of(std::vector<double> values, double quantile) {
    const auto rank =
        static_cast<std::ptrdiff_t>(std::ceil(quantile * static_cast<double>(values.size()))) - 1;
    const auto position = values.begin() + std::max<std::ptrdiff_t>(rank, 0);
    std::ranges::nth_element(values, position);
    return *position;
}

} // namespace dfdyn::tools
