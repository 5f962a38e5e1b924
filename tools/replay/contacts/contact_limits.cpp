// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/contacts/contact_limits.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/model/run_time/contact_constants.hpp"
#include "tools/replay/contacts/joint_envelope.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>

namespace dfdyn::tools {

namespace {

constexpr double range_share = 0.995;
constexpr double least_limit = 1e-6;           // in units of noise_std
constexpr double speed_allowance = 0.05;       // rad/s
constexpr double acceleration_allowance = 0.2; // rad/s²
constexpr std::size_t fewest_peaks = 5;        // of a pass, for its share of the tail
constexpr double out_of_reach = 1e3;           // factor on limits that excludes any contact
constexpr std::int64_t peak_interval_ns = 1'000'000'000;
constexpr double hour_s = 3600;
constexpr std::size_t tail_part = 10; // the tail is the largest tenth of the peaks
constexpr std::size_t least_tail = 10;
constexpr double new_motion_factor = 1.08;
constexpr double least_rate_slope = 1e-3;

/// Returns the median standard deviation of the trained model's predictions, per joint.
std::vector<double> usual_deviations(std::span<const PredictedRow> rows, std::size_t joints) {
    std::vector<double> usual;
    for (std::size_t k = 0; k < joints; ++k) {
        std::vector<double> values;
        for (const PredictedRow& row : rows) {
            if (row.pass == held_out_blocks) {
                values.push_back(row.standard_deviation[k]);
            }
        }
        usual.push_back(values.empty() ? double{no_contact_limit} : median(std::move(values)));
    }
    return usual;
}

/// Appends the limits of a joint.
void add_joint(ContactModel& contact, const JointEnvelope& joint) {
    const Deviations& deviations = joint.deviations;
    contact.limit.insert(contact.limit.end(), joint.envelope.limit.begin(), joint.envelope.limit.end());
    contact.relative.push_back(joint.envelope.relative);
    contact.hysteresis.push_back(joint.hysteresis);
    for (int motion = 0; motion < joint_motion_count; ++motion) {
        const std::vector<double> sizes = values_of(
            deviations, &Deviation::size, [&](const Deviation& one) { return one.motion == motion; });
        contact.usual.push_back(sizes.empty() ? 0 : median(sizes));
    }
    const auto largest_usual = [&](double Deviation::*value) {
        const auto any = [](const Deviation&) { return true; };
        return deviations.empty() ? 0 : quantile(values_of(deviations, value, any), range_share);
    };
    contact.speed.push_back(largest_usual(&Deviation::speed) + speed_allowance);
    contact.acceleration.push_back(largest_usual(&Deviation::acceleration) + acceleration_allowance);
}

/// Largest excesses of intervals of at most a second. A gap ends an interval early.
struct ExcessPeaks {
    std::vector<double> sizes;
    double covered_s = 0; ///< duration of all intervals
};

using PassPeaks = std::array<ExcessPeaks, held_out_blocks + 1>;

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
    std::vector<double> least = model.outputs.noise_std;
    for (double& value : least) {
        value *= least_limit;
    }
    ContactModel contact;
    for (const JointEnvelope& joint : joint_envelopes(rows, least)) {
        add_joint(contact, joint);
    }
    set_rate(contact, comparable_peaks(excess_peaks(rows, contact, model.sample_period_s)));
    contact.standard_deviation = usual_deviations(rows, least.size());
    return contact;
}

} // namespace dfdyn::tools
