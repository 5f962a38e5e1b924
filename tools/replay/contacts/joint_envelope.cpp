// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/contacts/joint_envelope.hpp"

#include "tools/base/numerics/quantile.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double envelope_share = 0.999;
constexpr double floor_share = 0.9;
constexpr double standing_share = 0.5;
constexpr std::size_t fewest_values = 20; // of a motion, for its own envelope
constexpr double most_median = 2;         // of a held-out block, relative to the trained model's
constexpr std::array relative_choices{0.0, 0.03, 0.05, 0.08, 0.12, 0.18, 0.25, 0.35, 0.5, 0.7};
constexpr std::array friction_choices{0.25, 0.5, 0.75, 1.0, 1.5}; // of the friction that explains nearly all
constexpr double friction_share = 0.99;
constexpr double least_hysteresis = 0.5; // in units of the friction, to compute it from a deviation
constexpr double worthwhile = 0.97;      // factor on the mean of the envelope with hysteresis

/// Returns the deviations of each joint without limits. `friction`: per joint, of the hysteresis.
std::vector<Deviations> deviations_of(std::span<const PredictedRow> rows,
                                      const std::vector<double>& friction) {
    std::vector<Deviations> deviations(friction.size());
    ContactModel contact = unlimited_contact(friction.size());
    contact.hysteresis = friction;
    const auto add = [&](const PredictedRow& row, const ContactWatch::Detector& detector) {
        for (std::size_t k = 0; k < deviations.size(); ++k) {
            const int joint = static_cast<int>(k);
            const auto magnitude = [](float value) { return std::abs(static_cast<double>(value)); };
            const double deviation = detector.deviation(joint);
            const double low = detector.hysteresis(joint).low();
            const double high = detector.hysteresis(joint).high();
            const double larger = high > -low ? high : low;
            deviations[k].push_back(
                {row.pass, static_cast<int>(detector.motion(joint)), std::abs(deviation),
                 magnitude(detector.predicted_change(joint)), magnitude(detector.speed(joint)),
                 magnitude(detector.acceleration(joint)), std::abs(larger),
                 larger != 0 ? std::max(deviation / larger, 0.0) : 0, friction[k] * (high - low)});
        }
    };
    detect(rows, contact, add);
    return deviations;
}

constexpr auto in_any_motion = [](const Deviation&) { return true; };

auto in_motion(int motion) {
    return [motion](const Deviation& one) { return one.motion == motion; };
}

using Passes = std::array<bool, held_out_blocks + 1>;

/// Returns which passes have a median deviation of at most `most_median` times the trained model's. Some
/// held-out blocks have a motion that the others do not determine: their errors are not typical of the model.
Passes determined_passes(const Deviations& deviations) {
    std::array<std::vector<double>, held_out_blocks + 1> sizes;
    for (const Deviation& one : deviations) {
        sizes[one.pass].push_back(one.size);
    }
    Passes determined{};
    const double trained = sizes.back().empty() ? 0 : median(sizes.back());
    for (std::size_t pass = 0; pass <= held_out_blocks; ++pass) {
        determined[pass] = !sizes[pass].empty() && median(sizes[pass]) <= most_median * trained;
    }
    return determined;
}

/// Returns the quantile of `value(deviation)` over those that `chosen` accepts; 0 if there are few.
template <class Value, class Chosen>
double quantile_of(const Deviations& deviations, Value value, Chosen chosen, double share) {
    const std::vector<double> values = values_of(deviations, value, chosen);
    return values.size() < fewest_values ? 0 : quantile(values, share);
}

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

/// An envelope, and the mean logarithm of the push that exceeds it. One against the friction that a joint
/// keeps need not exceed the range that hysteresis explains.
struct ScoredEnvelope {
    Envelope envelope;
    double score = std::numeric_limits<double>::infinity();
};

ScoredEnvelope tightest_envelope(const Deviations& deviations, const Passes& determined, double least) {
    Deviations typical;
    std::ranges::copy_if(deviations, std::back_inserter(typical),
                         [&](const Deviation& one) { return determined[one.pass]; });
    const double floor = std::max(quantile_of(typical, &Deviation::size, in_any_motion, floor_share), least);
    ScoredEnvelope tightest;
    for (const double relative : relative_choices) {
        const Envelope envelope = envelope_with(typical, relative, floor);
        double score = 0;
        for (const Deviation& one : deviations) {
            score +=
                std::log(envelope.at(one) + 0.5 * one.explained) / static_cast<double>(deviations.size());
        }
        if (score < tightest.score) {
            tightest = {envelope, score};
        }
    }
    return tightest;
}

/// Returns the friction whose hysteresis explains nearly all deviations where it acts.
double explaining_friction(const Deviations& deviations) {
    const auto acts = [](const Deviation& one) { return one.hysteresis > least_hysteresis; };
    return quantile_of(deviations, &Deviation::friction, acts, friction_share);
}

} // namespace

std::vector<JointEnvelope> joint_envelopes(std::span<const PredictedRow> rows,
                                           std::span<const double> least) {
    const std::size_t joints = least.size();
    std::vector<Deviations> deviations = deviations_of(rows, std::vector<double>(joints, 0));
    std::vector<JointEnvelope> best(joints);
    std::vector<double> score(joints), friction(joints);
    std::vector<Passes> determined(joints);
    for (std::size_t k = 0; k < joints; ++k) {
        determined[k] = determined_passes(deviations[k]);
        friction[k] = explaining_friction(deviations[k]);
        const ScoredEnvelope without = tightest_envelope(deviations[k], determined[k], least[k]);
        best[k] = {std::move(deviations[k]), without.envelope};
        score[k] = without.score + std::log(worthwhile);
    }
    for (const double choice : friction_choices) {
        std::vector<double> tried = friction;
        for (double& value : tried) {
            value *= choice;
        }
        deviations = deviations_of(rows, tried);
        for (std::size_t k = 0; k < joints; ++k) {
            const ScoredEnvelope with = tightest_envelope(deviations[k], determined[k], least[k]);
            if (with.score < score[k]) {
                best[k] = {std::move(deviations[k]), with.envelope, tried[k]};
                score[k] = with.score;
            }
        }
    }
    return best;
}

} // namespace dfdyn::tools
