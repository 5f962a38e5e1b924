// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/contacts/contact_limits.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/replay/contacts/contact_estimator.hpp"
#include "tools/replay/recorded_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace dfdyn::tools {

namespace {

constexpr std::size_t block_count = 4;
constexpr int any_motion = -1;
constexpr double tail_share = 0.995;
constexpr double floor_share = 0.9;
constexpr double tail_factor = 2.64;
constexpr double largest_factor = 1.375;
constexpr double excess_factor = 1.2;
constexpr double standing_share = 1.0 / 3;
constexpr double least_limit = 1e-6; // in units of noise_std

/// Magnitude of a joint's deviation in a tick.
struct Deviation {
    int motion = 0;
    double size = 0;
};

/// Magnitudes of all joints, by joint.
using Deviations = std::vector<std::vector<Deviation>>;

/// A row with the error of its prediction.
struct PredictedRow {
    std::int64_t time_ns = 0;
    bool begins = false; ///< does not follow the row before
    std::vector<float> position, error;
};

/// Appends the rows from `first` to `last` that are predicted, without learning.
void predict_rows(HostEstimator& estimator, std::span<const Recording> recordings, std::size_t first,
                  std::size_t last, std::vector<PredictedRow>& predicted) {
    bool follows = false;
    tick_rows(estimator, recordings, first, last, Budget::predict_only(),
              [&](const MeasuredSample& sample, const Tick& tick, bool begins) {
                  follows = follows && !begins && tick.status.predicted();
                  if (tick.status.predicted()) {
                      predicted.push_back({sample.time_ns,
                                           !follows,
                                           {sample.position.begin(), sample.position.end()},
                                           prediction_errors(sample, tick)});
                      follows = true;
                  }
              });
}

void learn_rows_of(HostEstimator& estimator, std::span<const Recording> recordings, std::size_t first,
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
        predict_rows(*estimator, recordings, first, last, predicted);
    }
    predict_rows(*make_estimator(model, false), recordings, 0, rows, predicted);
    return predicted;
}

/// Runs a detector over the rows; calls `use(detector)` after each but the first of a recording.
template <class Use>
void detect(std::span<const PredictedRow> rows, const ContactModel& contact, Use use) {
    ContactWatch watch(contact);
    for (const PredictedRow& row : rows) {
        if (row.begins) {
            watch.interrupt();
        }
        watch.tick(row.time_ns, row.position, row.error);
        use(watch.detector());
    }
}

/// Returns the deviations of `joints` without limits.
Deviations deviations_of(std::span<const PredictedRow> rows, std::size_t joints) {
    Deviations deviations(joints);
    detect(rows, unlimited_contact(joints), [&](const ContactWatch::Detector& detector) {
        for (std::size_t k = 0; k < joints; ++k) {
            const int joint = static_cast<int>(k);
            deviations[k].push_back({static_cast<int>(detector.motion(joint)),
                                     std::abs(static_cast<double>(detector.deviation(joint)))});
        }
    });
    return deviations;
}

/// Returns the largest excess of a detector with these limits.
double largest_excess(std::span<const PredictedRow> rows, const ContactModel& contact) {
    double largest = 0;
    detect(rows, contact, [&largest](const ContactWatch::Detector& detector) {
        largest = std::max(largest, static_cast<double>(detector.excess()));
    });
    return largest;
}

/// Returns the sizes of the deviations in one motion, or in all: `any_motion`.
std::vector<double> sizes_of(const std::vector<Deviation>& deviations, int motion) {
    std::vector<double> sizes;
    for (const Deviation& one : deviations) {
        if (motion == any_motion || one.motion == motion) {
            sizes.push_back(one.size);
        }
    }
    return sizes;
}

std::array<double, joint_motion_count> limits_of_joint(const std::vector<Deviation>& deviations,
                                                       double least) {
    const std::vector<double> all = sizes_of(deviations, any_motion);
    const double floor = all.empty() ? least : std::max(quantile(all, floor_share), least);
    std::array<double, joint_motion_count> limits{};
    for (int motion = 0; motion < joint_motion_count; ++motion) {
        const std::vector<double> sizes = sizes_of(deviations, motion);
        const double tail = sizes.empty() ? 0 : quantile(sizes, tail_share);
        const double largest = sizes.empty() ? 0 : *std::ranges::max_element(sizes);
        limits[static_cast<std::size_t>(motion)] =
            std::max(tail_factor * std::max(tail, floor), largest_factor * largest);
    }
    limits[0] = std::max(limits[0], standing_share * limits[1]);
    return limits;
}

} // namespace

ContactModel measure_contact_limits(const TrainedModel& model, std::span<const Recording> recordings) {
    const std::vector<PredictedRow> rows = calibration_rows(model, recordings);
    const Deviations deviations = deviations_of(rows, model.outputs.names.size());
    ContactModel contact;
    for (std::size_t k = 0; k < deviations.size(); ++k) {
        const auto limits = limits_of_joint(deviations[k], least_limit * model.outputs.noise_std[k]);
        contact.limit.insert(contact.limit.end(), limits.begin(), limits.end());
        for (int motion = 0; motion < joint_motion_count; ++motion) {
            const std::vector<double> sizes = sizes_of(deviations[k], motion);
            contact.usual.push_back(sizes.empty() ? 0 : median(sizes));
        }
    }
    const double factor = std::max(1.0, excess_factor * largest_excess(rows, contact));
    for (double& limit : contact.limit) {
        limit *= factor;
    }
    return contact;
}

} // namespace dfdyn::tools
