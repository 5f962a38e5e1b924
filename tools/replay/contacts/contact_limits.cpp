// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/contacts/contact_limits.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/replay/contacts/contact_estimator.hpp"
#include "tools/replay/recorded_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <limits>

namespace dfdyn::tools {

namespace {

constexpr std::size_t block_count = 8; // held out in turn; the last pass of all is the trained model's
constexpr double envelope_share = 0.999;
constexpr double floor_share = 0.9;
constexpr double range_share = 0.995;
constexpr double standing_share = 0.5;
constexpr double least_limit = 1e-6;           // in units of noise_std
constexpr double speed_allowance = 0.05;       // rad/s
constexpr double acceleration_allowance = 0.2; // rad/s²
constexpr std::size_t fewest_values = 20;      // of a motion, for its own envelope
constexpr double most_median = 2;              // of a held-out block, relative to the trained model's
constexpr std::size_t fewest_peaks = 5;        // of a pass, for its share of the tail
constexpr std::array relative_choices{0.0, 0.03, 0.05, 0.08, 0.12, 0.18, 0.25, 0.35, 0.5, 0.7};
constexpr double out_of_reach = 1e3; // factor on limits that excludes any contact
constexpr std::int64_t peak_interval_ns = 1'000'000'000;
constexpr double hour_s = 3600;
constexpr std::size_t tail_part = 10; // the tail is the largest tenth of the peaks
constexpr std::size_t least_tail = 10;
constexpr double new_motion_factor = 1.08;
constexpr double least_rate_slope = 1e-3;

/// Deviation and motion of a joint in one tick.
struct Deviation {
    std::size_t pass = 0;
    int motion = 0;
    double size = 0;   ///< magnitude of the deviation
    double change = 0; ///< magnitude of the prediction's recent change
    double speed = 0, acceleration = 0;
};

using Deviations = std::vector<Deviation>; ///< of a joint

/// A row with the error of its prediction. `pass`: number of the held-out block, or `block_count`.
struct PredictedRow {
    std::size_t pass = 0;
    std::int64_t time_ns = 0;
    bool begins = false; ///< does not follow the row before
    std::vector<float> position, error, prediction, standard_deviation;
};

/// Appends the rows from `first` to `last` that are predicted, without learning.
void predict_rows(RuntimeEstimator& estimator, std::span<const Recording> recordings, std::size_t first,
                  std::size_t last, std::size_t pass, std::vector<PredictedRow>& predicted) {
    bool follows = false;
    tick_rows(estimator, recordings, first, last, Budget::predict_only(),
              [&](const MeasuredSample& sample, const Tick& tick, bool begins) {
                  follows = follows && !begins && tick.status.estimated();
                  if (tick.status.estimated()) { // as in the firmware, also at the model's bound
                      predicted.push_back({pass,
                                           sample.time_ns,
                                           !follows,
                                           {sample.position.begin(), sample.position.end()},
                                           prediction_errors(sample, tick),
                                           {tick.prediction.begin(), tick.prediction.end()},
                                           {tick.standard_deviation.begin(), tick.standard_deviation.end()}});
                      follows = true;
                  }
              });
}

void learn_rows_of(RuntimeEstimator& estimator, std::span<const Recording> recordings, std::size_t first,
                   std::size_t last) {
    tick_rows(estimator, recordings, first, last, Budget::unlimited(),
              [](const MeasuredSample&, const Tick&, bool) {});
}

/// Predicts each block of time by an estimator that has learned all others, and then all rows by the model.
std::vector<PredictedRow> calibration_rows(const TrainedModel& model, std::span<const Recording> recordings) {
    const std::size_t rows = total_rows(recordings);
    std::vector<PredictedRow> predicted;
    for (std::size_t block = 0; block < block_count; ++block) {
        const std::size_t first = rows * block / block_count;
        const std::size_t last = rows * (block + 1) / block_count;
        const auto estimator = make_estimator(model, true);
        learn_rows_of(*estimator, recordings, 0, first);
        learn_rows_of(*estimator, recordings, last, rows);
        predict_rows(*estimator, recordings, first, last, block, predicted);
    }
    predict_rows(*make_estimator(model, false), recordings, 0, rows, block_count, predicted);
    return predicted;
}

/// Runs a detector over the rows; calls `use(row, detector)` after each.
template <class Use>
void detect(std::span<const PredictedRow> rows, const ContactModel& contact, Use use) {
    ContactWatch watch({contact});
    for (const PredictedRow& row : rows) {
        if (row.begins) {
            watch.interrupt();
        }
        watch.tick(row.time_ns, row.position, row.error, row.prediction, row.standard_deviation);
        use(row, watch.detector());
    }
}

/// Returns the median standard deviation of the trained model's predictions, per joint.
std::vector<double> usual_deviations(std::span<const PredictedRow> rows, std::size_t joints) {
    std::vector<double> usual;
    for (std::size_t k = 0; k < joints; ++k) {
        std::vector<double> values;
        for (const PredictedRow& row : rows) {
            if (row.pass == block_count) {
                values.push_back(row.standard_deviation[k]);
            }
        }
        usual.push_back(values.empty() ? double{no_contact_limit} : median(std::move(values)));
    }
    return usual;
}

/// Returns the deviations of each joint without limits.
std::vector<Deviations> deviations_of(std::span<const PredictedRow> rows, std::size_t joints) {
    std::vector<Deviations> deviations(joints);
    detect(rows, unlimited_contact(joints),
           [&](const PredictedRow& row, const ContactWatch::Detector& detector) {
               for (std::size_t k = 0; k < joints; ++k) {
                   const int joint = static_cast<int>(k);
                   const auto magnitude = [](float value) { return std::abs(static_cast<double>(value)); };
                   deviations[k].push_back(
                       {row.pass, static_cast<int>(detector.motion(joint)),
                        magnitude(detector.deviation(joint)), magnitude(detector.predicted_change(joint)),
                        magnitude(detector.speed(joint)), magnitude(detector.acceleration(joint))});
               }
           });
    return deviations;
}

/// Returns `value(deviation)` of those that `chosen` accepts.
template <class Value, class Chosen>
std::vector<double> values_of(const Deviations& deviations, Value value, Chosen chosen) {
    std::vector<double> values;
    for (const Deviation& one : deviations) {
        if (chosen(one)) {
            values.push_back(std::invoke(value, one));
        }
    }
    return values;
}

constexpr auto in_any_motion = [](const Deviation&) { return true; };

auto in_motion(int motion) {
    return [motion](const Deviation& one) { return one.motion == motion; };
}

/// Returns the deviations of a joint in the passes whose median deviation is at most `most_median` times the
/// trained model's. Some held-out blocks have a motion that the others do not determine: their errors are not
/// typical of the model.
Deviations of_determined_passes(const Deviations& deviations) {
    std::array<std::vector<double>, block_count + 1> sizes;
    for (const Deviation& one : deviations) {
        sizes[one.pass].push_back(one.size);
    }
    std::array<bool, block_count + 1> determined{};
    const double trained = sizes.back().empty() ? 0 : median(sizes.back());
    for (std::size_t pass = 0; pass <= block_count; ++pass) {
        determined[pass] = !sizes[pass].empty() && median(sizes[pass]) <= most_median * trained;
    }
    Deviations result;
    std::ranges::copy_if(deviations, std::back_inserter(result),
                         [&](const Deviation& one) { return determined[one.pass]; });
    return result;
}

/// Returns the quantile of `value(deviation)` over those that `chosen` accepts; 0 if there are few.
template <class Value, class Chosen>
double quantile_of(const Deviations& deviations, Value value, Chosen chosen, double share) {
    const std::vector<double> values = values_of(deviations, value, chosen);
    return values.size() < fewest_values ? 0 : quantile(values, share);
}

/// Limits of a joint that nearly all of its deviations satisfy.
struct Envelope {
    std::array<double, joint_motion_count> limit{};
    double relative = 0;

    double at(const Deviation& one) const {
        return std::hypot(limit[static_cast<std::size_t>(one.motion)], relative * one.change);
    }
};

Envelope envelope_with(const Deviations& deviations, double relative, double floor) {
    Envelope envelope{{}, relative};
    const auto unexplained = [relative](const Deviation& one) {
        const double explained = relative * one.change;
        return std::sqrt(std::max(one.size * one.size - explained * explained, 0.0));
    };
    for (int motion = 0; motion < joint_motion_count; ++motion) {
        const double tail = quantile_of(deviations, unexplained, in_motion(motion), envelope_share);
        envelope.limit[static_cast<std::size_t>(motion)] = std::max(tail, floor);
    }
    envelope.limit[0] = std::max(envelope.limit[0], standing_share * envelope.limit[1]);
    return envelope;
}

/// Returns the envelope with the smallest geometric mean of its limits.
Envelope tightest_envelope(const Deviations& deviations, double least) {
    const Deviations determined = of_determined_passes(deviations);
    const double floor =
        std::max(quantile_of(determined, &Deviation::size, in_any_motion, floor_share), least);
    Envelope tightest;
    double smallest = std::numeric_limits<double>::infinity();
    for (const double relative : relative_choices) {
        const Envelope envelope = envelope_with(determined, relative, floor);
        double sum = 0;
        for (const Deviation& one : deviations) {
            sum += std::log(envelope.at(one));
        }
        if (sum < smallest) {
            smallest = sum;
            tightest = envelope;
        }
    }
    return tightest;
}

/// Appends the limits of a joint.
void add_joint(ContactModel& contact, const Deviations& deviations, double least) {
    const Envelope envelope = tightest_envelope(deviations, least);
    contact.limit.insert(contact.limit.end(), envelope.limit.begin(), envelope.limit.end());
    contact.relative.push_back(envelope.relative);
    for (int motion = 0; motion < joint_motion_count; ++motion) {
        const std::vector<double> sizes = values_of(deviations, &Deviation::size, in_motion(motion));
        contact.usual.push_back(sizes.empty() ? 0 : median(sizes));
    }
    const auto largest_usual = [&](double Deviation::*value) {
        return deviations.empty() ? 0 : quantile(values_of(deviations, value, in_any_motion), range_share);
    };
    contact.speed.push_back(largest_usual(&Deviation::speed) + speed_allowance);
    contact.acceleration.push_back(largest_usual(&Deviation::acceleration) + acceleration_allowance);
}

/// Largest excesses of intervals of at most a second. A gap ends an interval early.
struct ExcessPeaks {
    std::vector<double> sizes;
    double covered_s = 0; ///< duration of all intervals
};

using PassPeaks = std::array<ExcessPeaks, block_count + 1>;

/// Returns the largest excess of each second, in each pass.
PassPeaks excess_peaks(std::span<const PredictedRow> rows, const ContactModel& contact, double period_s) {
    PassPeaks peaks;
    std::int64_t begin_ns = 0;
    std::int64_t before_ns = 0;
    detect(rows, scaled_contact(contact, out_of_reach),
           [&](const PredictedRow& row, const ContactWatch::Detector& detector) {
               ExcessPeaks& now = peaks[row.pass];
               if (row.begins || row.time_ns - begin_ns >= peak_interval_ns) {
                   now.sizes.push_back(0);
                   begin_ns = row.time_ns;
               }
               now.covered_s += row.begins ? period_s : 1e-9 * static_cast<double>(row.time_ns - before_ns);
               before_ns = row.time_ns;
               double& largest = now.sizes.back();
               largest = std::max(largest, out_of_reach * static_cast<double>(detector.excess()));
           });
    return peaks;
}

/// Returns the peaks of the trained model's pass and of all others with enough of them, in descending order.
/// Those of passes with a larger median than the trained model and half of the passes are scaled to it.
ExcessPeaks comparable_peaks(const PassPeaks& passes) {
    std::vector<std::span<const double>> counted;
    std::vector<double> medians;
    ExcessPeaks peaks;
    for (const ExcessPeaks& pass : passes) {
        if (pass.sizes.size() >= fewest_peaks || &pass == &passes.back()) {
            counted.emplace_back(pass.sizes);
            medians.push_back(pass.sizes.empty() ? 0 : median(pass.sizes));
            peaks.covered_s += pass.covered_s;
        }
    }
    const double usual = std::max(median(medians), medians.back());
    for (std::size_t i = 0; i < counted.size(); ++i) {
        const double factor = medians[i] > usual ? usual / medians[i] : 1;
        std::ranges::transform(counted[i], std::back_inserter(peaks.sizes),
                               [factor](double peak) { return factor * peak; });
    }
    std::ranges::sort(peaks.sizes, std::greater{});
    return peaks;
}

/// Returns the factor from the mean of `count` exponential values to the upper 90 % confidence limit of the
/// mean.
double upper_mean(std::size_t count) {
    constexpr double normal_quantile = -1.2816;                  // 10 %
    return 1 / mean_square_quantile(2 * count, normal_quantile); // an exponential value is two squares
}

/// Sets the limits to those that are exceeded at most `contact_rate_per_hour` times on average. The largest
/// tenth of the peaks has an exponential tail. With few peaks its mean is uncertain.
void set_rate(ContactModel& contact, const ExcessPeaks& all) {
    const std::vector<double>& peaks = all.sizes;
    const std::size_t tail = std::max(std::min(peaks.size() / 2, least_tail), peaks.size() / tail_part);
    if (tail == 0) {
        return;
    }
    const double threshold = peaks[tail];
    double mean = 0;
    for (std::size_t i = 0; i < tail; ++i) {
        mean += (peaks[i] - threshold) / static_cast<double>(tail);
    }
    mean *= tail < least_tail ? upper_mean(tail) : 1;
    const double per_hour = hour_s * static_cast<double>(tail) / all.covered_s;
    const double level = std::max(threshold + mean * std::log(per_hour / contact_rate_per_hour), 1.0);
    contact = scaled_contact(contact, new_motion_factor * level);
    contact.rate_slope = std::max(mean / level, least_rate_slope);
}

} // namespace

ContactModel measure_contact_limits(const TrainedModel& model, std::span<const Recording> recordings) {
    const std::vector<PredictedRow> rows = calibration_rows(model, recordings);
    const std::vector<Deviations> deviations = deviations_of(rows, model.outputs.names.size());
    ContactModel contact;
    for (std::size_t k = 0; k < deviations.size(); ++k) {
        add_joint(contact, deviations[k], least_limit * model.outputs.noise_std[k]);
    }
    set_rate(contact, comparable_peaks(excess_peaks(rows, contact, model.sample_period_s)));
    contact.standard_deviation = usual_deviations(rows, deviations.size());
    return contact;
}

} // namespace dfdyn::tools
