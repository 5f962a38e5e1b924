// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/replay.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/replay/output_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dfdyn::tools {

namespace {

constexpr float not_predicted = std::numeric_limits<float>::quiet_NaN();
constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

void check_fit(const TrainedModel& model, const Recording& recording) {
    const auto joints = static_cast<std::size_t>(model.joints);
    if (recording.joint_count() != joints) {
        throw InputError(recording.source + ": expected positions of " + std::to_string(joints) +
                         " joints as the model has, found " + std::to_string(recording.joint_count()));
    }
    if (recording.output.names != model.outputs.names) {
        throw InputError(recording.source + ": expected the model's outputs " + listed(model.outputs.names) +
                         ", found " + listed(recording.output.names));
    }
    if (needs_derivatives(model) && !(recording.velocity.present() && recording.acceleration.present())) {
        throw InputError(recording.source + ": expected columns qd1… and qdd1…, whose derivatives the model "
                                            "was trained with, found none");
    }
}

} // namespace

MeasuredSample sample_at(const Recording& recording, std::size_t row) {
    const auto derivative = [&](const Columns& columns) {
        return columns.present() ? columns.row(row) : std::span<const double>();
    };
    return {recording.time_ns[row], recording.position.row(row), derivative(recording.velocity),
            derivative(recording.acceleration), recording.output.row(row)};
}

bool needs_derivatives(const TrainedModel& model) {
    const auto measured = [](const InputModel& input) {
        return input_description(input.kind).uses_derivatives() && input.derivatives == Derivatives::measured;
    };
    return (model.features.count > 0 && measured(model.input)) ||
           (model.physics && measured(model.physics->motion));
}

std::string_view reason_name(const ReplayedRecording& replayed, std::size_t tick) {
    const hal::Reason bus = replayed.bus_reason.empty() ? hal::Reason::ok : replayed.bus_reason[tick];
    return bus != hal::Reason::ok ? hal::name(bus) : name(replayed.status[tick].reason());
}

Replayer::Replayer(RuntimeEstimator& estimator, std::string source, std::size_t outputs, std::size_t horizon,
                   const ReplayMemory& memory)
    : estimator_(estimator), outputs_(outputs), horizon_(horizon),
      errors_(std::max<std::size_t>(horizon, 1), outputs, estimator.weight_count()), memory_(memory) {
    replayed_.source = std::move(source);
    for_each_column(
        // writes to the vectors, because the system provides memory at the first write
        [&](auto& column, std::size_t width) {
            column.resize(2 * memory.kept_ticks * width);
            column.clear();
        });
}

template <class Use>
void Replayer::for_each_column(Use use) {
    use(replayed_.time_s, 1);
    use(replayed_.measured, outputs_);
    use(replayed_.predicted, outputs_);
    use(replayed_.standard_deviation, outputs_);
    use(replayed_.normalised_innovation_squared, 1);
    use(replayed_.status, 1);
    use(replayed_.bus_reason, 1);
    use(replayed_.duration_us, 1);
}

void Replayer::begin_recording() {
    estimator_.begin_recording();
    errors_.interrupt();
}

void Replayer::tick(double time_s, const MeasuredSample& sample) {
    estimate(time_s, sample);
    complete_tick();
}

void Replayer::tick(double time_s, const MeasuredSample& sample, hal::Reason output) {
    estimate(time_s, sample);
    replayed_.bus_reason.push_back(replayed_.status.back().estimated() ? output : hal::Reason::ok);
    complete_tick();
}

void Replayer::skip(double time_s, hal::Reason position) {
    Tick tick;
    tick.status.prediction = Reason::gap; // the estimator will report the same reason
    replayed_.time_s.push_back(time_s);
    append(tick, {});
    replayed_.bus_reason.push_back(position);
    errors_.skip();
    complete_tick();
}

ReplayedRecording Replayer::finish() {
    replayed_.horizon = errors_.indices();
    for (HorizonIndex& index : replayed_.horizon) {
        index.tick -= replayed_.forgotten;
    }
    return std::move(replayed_);
}

void Replayer::estimate(double time_s, const MeasuredSample& sample) {
    const Tick tick = estimator_.tick(sample);
    replayed_.clock_origin_s = time_s - 1e-9 * static_cast<double>(sample.time_ns);
    replayed_.time_s.push_back(time_s);
    append(tick, sample.output);
    if (!tick.status.estimated() || sample.output.empty()) {
        errors_.skip();
    } else if (horizon_ > 0) {
        errors_.add(estimator_, sample.output);
    }
}

/// Updates the totals with the last tick, passes it to the sink, and removes the oldest ticks if there are
/// too many.
void Replayer::complete_tick() {
    const std::size_t last = replayed_.time_s.size() - 1;
    ReplayTotals& totals = replayed_.totals;
    replayed_.start_s = totals.ticks == 0 ? replayed_.time_s[last] : replayed_.start_s;
    ++totals.ticks;
    totals.predicted += replayed_.status[last].estimated() ? 1 : 0;
    totals.learned += replayed_.status[last].learned() ? 1 : 0;
    ++totals.reasons[reason_name(replayed_, last)];
    if (memory_.sink != nullptr) {
        memory_.sink->take(replayed_, last);
    }
    if (memory_.kept_ticks > 0 && replayed_.time_s.size() == 2 * memory_.kept_ticks) {
        for_each_column([&](auto& column, std::size_t width) {
            const auto count = std::min(memory_.kept_ticks * width, column.size());
            column.erase(column.begin(), column.begin() + static_cast<std::ptrdiff_t>(count));
        });
        replayed_.forgotten += memory_.kept_ticks;
        errors_.forget_before(replayed_.forgotten);
    }
}

void Replayer::append(const Tick& tick, std::span<const double> output) {
    const bool predicted = tick.status.estimated();
    for (std::size_t k = 0; k < outputs_; ++k) {
        replayed_.measured.push_back(output.empty() ? not_measured : output[k]);
        replayed_.predicted.push_back(predicted ? tick.prediction[k] : not_predicted);
        replayed_.standard_deviation.push_back(predicted ? tick.standard_deviation[k] : not_predicted);
    }
    replayed_.normalised_innovation_squared.push_back(
        predicted && !output.empty() ? tick.normalised_innovation_squared : not_predicted);
    replayed_.status.push_back(tick.status);
    replayed_.duration_us.push_back(std::chrono::duration<double, std::micro>(tick.duration).count());
}

namespace {

/// Returns the first position of `recording` beyond the limit of a model, in words; empty: none.
std::string first_beyond_limit(std::span<const TrainedModel> models, const Recording& recording) {
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        const std::span<const double> position = recording.position.row(row);
        for (const TrainedModel& model : models) {
            const std::vector<double>& limits = model.limits.position_rad;
            for (std::size_t joint = 0; joint < std::min(limits.size(), position.size()); ++joint) {
                if (std::abs(position[joint]) > limits[joint]) {
                    return recording.position.names[joint] + ": expected from " +
                           rounded_text(-limits[joint]) + " to " + rounded_text(limits[joint]) + ", found " +
                           rounded_text(position[joint]);
                }
            }
        }
    }
    return "";
}

} // namespace

ReplayedRecording replay(RuntimeEstimator& estimator, std::span<const TrainedModel> models,
                         const Recording& recording, std::size_t horizon,
                         const std::function<void(std::size_t)>& on_tick) {
    for (const TrainedModel& model : models) {
        check_fit(model, recording);
    }
    Replayer replayer(estimator, recording.source, recording.output.names.size(), horizon);
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        if (recording.gap_before[row] != 0) {
            replayer.begin_recording();
        }
        replayer.tick(recording.time_s[row], sample_at(recording, row));
        on_tick(row + 1);
    }
    ReplayedRecording replayed = replayer.finish();
    if (replayed.totals.predicted == 0) {
        replayed.beyond_limit = first_beyond_limit(models, recording);
    }
    return replayed;
}

double normalised_error(const ReplayedRecording& replayed, std::size_t outputs, std::size_t output,
                        std::size_t first, std::size_t last) {
    OutputError error;
    for (std::size_t tick = first; tick < last; ++tick) {
        const std::size_t element = tick * outputs + output;
        error.add(replayed.measured[element], static_cast<double>(replayed.predicted[element]));
    }
    return error.normalised();
}

double share_within_two_deviations(const ReplayedRecording& replayed, std::size_t outputs,
                                   std::size_t output) {
    std::size_t predicted = 0;
    std::size_t within = 0;
    for (std::size_t element = output; element < replayed.predicted.size(); element += outputs) {
        if (!std::isnan(replayed.predicted[element]) && !std::isnan(replayed.measured[element])) {
            const double error =
                replayed.measured[element] - static_cast<double>(replayed.predicted[element]);
            ++predicted;
            within +=
                std::abs(error) <= 2 * static_cast<double>(replayed.standard_deviation[element]) ? 1 : 0;
        }
    }
    return static_cast<double>(within) / static_cast<double>(predicted);
}

double median_horizon_index(const ReplayedRecording& replayed, std::size_t output, double from_s,
                            double to_s) {
    std::vector<double> values;
    for (const HorizonIndex& index : replayed.horizon) {
        const double t = replayed.time_s[index.tick] - replayed.start_s;
        if (t >= from_s && t < to_s) {
            values.push_back(index.epsilon[output]);
        }
    }
    return median(std::move(values));
}

} // namespace dfdyn::tools
