// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/search/stationary_contacts.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/candidates/event_windows.hpp"
#include "tools/diagnosis/verdict/found_parameters.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

constexpr double beside_s = 0.25; ///< of the same standstill, before and after a contact
constexpr double between_s = 0.5; ///< pulses closer than this belong to the same contact
constexpr double least_probability = 0.25;
constexpr double certain_probability = 0.95;
constexpr std::ptrdiff_t most_uncertain = 3; ///< contacts that are not certain, at a joint
constexpr double known_deviations = 4;       ///< minimum ratio of known friction to its standard deviation
constexpr double uncertain_share = 0.2;      ///< standard deviation, as a share of the rigid body's change

/// Largest dry friction torque of a joint (N·m) and its variance.
struct Holding {
    double most = 0, variance = 0;

    /// Friction with a large relative uncertainty is treated as unknown: if it were too small, every
    /// standstill would contain contacts.
    bool known() const { return most > known_deviations * std::sqrt(variance); }
};

/// Returns the largest dry friction parameter; null if the effect is no dry friction.
const FoundParameter* dry_friction(const std::vector<FoundParameter>& parameters) {
    constexpr std::array<std::string_view, 6> names{"coulomb", "coulomb_pos", "coulomb_neg",
                                                    "static",  "break_away",  "mu"};
    const FoundParameter* largest = nullptr;
    for (const FoundParameter& one : parameters) {
        if (std::ranges::count(names, one.name) > 0 &&
            (largest == nullptr || std::abs(one.value) > std::abs(largest->value))) {
            largest = &one;
        }
    }
    return largest;
}

Holding holding_at(const DiagnosisSignals& signals, const FittedEffects& fitted_effects, Eigen::Index joint) {
    const std::string where = place_text(PlaceKind::joint, static_cast<std::size_t>(joint));
    const std::vector<ChosenShape> named = fitted_effects.named_effects();
    Holding result;
    for (std::size_t i = 0; i < named.size(); ++i) {
        const Candidate& candidate = fitted_effects.candidates[named[i].candidate];
        if (candidate.where != where) {
            continue;
        }
        const std::vector<FoundParameter> parameters = found_parameters(fitted_effects, i);
        if (const FoundParameter* const friction = dry_friction(parameters)) {
            const bool by_load = friction->name == "mu";
            const double scale = by_load ? signals.joint_torque.col(joint).cwiseAbs().maxCoeff() : 1;
            result.most += scale * std::abs(friction->value);
            result.variance += std::pow(scale * deviation_of(*friction), 2);
        }
    }
    return result;
}

/// Fits a contact pulse with level rows before and after it.
class PulseFit {
  public:
    PulseFit(double length_s, double rate_hz)
        : beside_(std::llround(beside_s * rate_hz)), shape_(std::llround(length_s * rate_hz)) {
        const ContactPulse pulse{0, length_s, push_flanks * length_s};
        for (Eigen::Index row = 0; row < shape_.size(); ++row) {
            shape_[row] = pulse_at(pulse, (static_cast<double>(row) + 0.5) / rate_hz);
        }
    }

    Eigen::Index rows() const { return 2 * beside_ + shape_.size(); }
    Eigen::Index beside() const { return beside_; }
    Eigen::Index step() const { return std::max<Eigen::Index>(1, shape_.size() / 8); }

    struct Result {
        double height = 0;
        double share = 0; ///< of the squares that the pulse explains
    };

    /// Fits from row `first` on, relative to a straight line from the level before the pulse to the level
    /// after it.
    Result of(const Eigen::VectorXd& series, Eigen::Index first) const {
        const double before = series.segment(first, beside_).mean();
        const double behind = series.segment(first + beside_ + shape_.size(), beside_).mean();
        const double step = (behind - before) / static_cast<double>(beside_ + shape_.size());
        const double start = before + step * (static_cast<double>(beside_) + 1) / 2;
        const Eigen::VectorXd pulse =
            series.segment(first + beside_, shape_.size()) -
            Eigen::VectorXd::LinSpaced(shape_.size(), start,
                                       start + step * static_cast<double>(shape_.size() - 1));
        const double product = shape_.dot(pulse);
        return {product / shape_.squaredNorm(),
                product * product / (shape_.squaredNorm() * std::max(pulse.squaredNorm(), 1e-300))};
    }

    /// Returns the variance of a height, per variance of a row of white noise.
    double variance() const {
        const double by_line = std::pow(shape_.sum() / shape_.squaredNorm(), 2);
        return 1 / shape_.squaredNorm() + by_line / (2 * static_cast<double>(beside_));
    }

  private:
    Eigen::Index beside_;
    Eigen::VectorXd shape_;
};

/// A pulse of a joint's torque during standstill.
struct StandPulse : EventWindow {
    std::size_t length = 0; ///< index of the pulse length
    Eigen::Index first = 0; ///< row
    double height = 0;      ///< N·m, the smaller one of both residuals
    double rest = 0;        ///< N·m, in the residual after the fitted effects
};

/// Robust standard deviation of the pulses of one length, from the median of their magnitudes.
double height_deviation(const std::vector<StandPulse>& pulses, std::size_t length) {
    std::vector<double> heights;
    for (const StandPulse& pulse : pulses) {
        if (pulse.length == length) {
            heights.push_back(std::abs(pulse.rest));
        }
    }
    return median_to_deviation * median(std::move(heights));
}

/// Noise of a joint at rest, as a first-order autoregressive process: from the medians of its changes from
/// row to row and over `2 apart` rows relative to a straight line, because its friction yields seldom and
/// creeps.
class StandNoise {
  public:
    void add(const Eigen::VectorXd& stand, Eigen::Index apart) {
        for (Eigen::Index row = apart; row + apart < stand.size(); ++row) {
            over_one_.push_back(std::abs(stand[row] - stand[row - 1]));
            const double bend = stand[row - apart] - 2 * stand[row] + stand[row + apart];
            over_many_.push_back(std::abs(bend) / std::numbers::sqrt3); // varies as a change does
        }
    }

    /// Returns the variance of a row of white noise whose mean over many rows varies as much.
    double variance() const {
        constexpr double most_correlated = 0.99;
        const double over_many = median(over_many_);
        const double over_one = std::min(median(over_one_), over_many);
        const double correlation =
            std::min(1 - std::pow(over_one / std::max(over_many, 1e-300), 2), most_correlated);
        return std::pow(median_to_deviation * over_many, 2) / 2 * (1 + correlation) / (1 - correlation);
    }

  private:
    std::vector<double> over_one_, over_many_; ///< changes, by the number of rows
};

/// Searches for contacts at one joint during its standstills.
class JointStands {
  public:
    /// `missed`: residual of the rigid body; `rest`: residual after the fitted effects.
    JointStands(const DiagnosisSignals& signals, Eigen::Index joint, Eigen::VectorXd missed,
                Eigen::VectorXd rest)
        : signals_(signals), joint_(joint), missed_(std::move(missed)), rest_(std::move(rest)) {
        for (const double length_s : push_lengths_s) {
            fits_.emplace_back(length_s, signals.measured.rate_hz);
        }
        for (const Stretch& stretch : signals.measured.stretches) {
            add_stands(stretch);
        }
    }

    /// Returns true if no standstill is long enough for a contact.
    bool none() const { return pulses_.empty(); }

    std::vector<StationaryContact> contacts(const Holding& holding) const {
        const double noise_variance = noise_.variance();
        std::vector<StationaryContact> result;
        for (const StandPulse& pulse : events_of(pulses_, between_s)) {
            StationaryContact contact = contact_of(pulse, holding, noise_variance);
            if (contact.probability() >= least_probability) {
                contact.share = contact.change * pulse_series(signals_, contact.pulse);
                result.push_back(std::move(contact));
            }
        }
        const auto uncertain = [](const StationaryContact& one) {
            return one.probability() < certain_probability;
        };
        if (std::ranges::count_if(result, uncertain) > most_uncertain) {
            std::erase_if(result, uncertain); // the joint deviates more than its friction and its noise allow
        }
        return result;
    }

  private:
    static PulseFit::Result smaller(const PulseFit::Result& one, const PulseFit::Result& other) {
        if (one.height * other.height <= 0) {
            return {};
        }
        return std::abs(one.height) < std::abs(other.height) ? one : other;
    }

    void add_stands(const Stretch& stretch) {
        const auto weight = signals_.measured.weight.col(joint_);
        const Eigen::Index end = stretch.first + stretch.count;
        for (Eigen::Index first = stretch.first; first < end; ++first) {
            Eigen::Index last = first;
            while (last < end && weight[last] == 0) {
                ++last;
            }
            add_pulses(first, last);
            noise_.add(rest_.segment(first, last - first), fits_.front().beside() / 2);
            first = last;
        }
    }

    void add_pulses(Eigen::Index first, Eigen::Index last) {
        for (std::size_t length = 0; length < fits_.size(); ++length) {
            const PulseFit& fit = fits_[length];
            for (Eigen::Index row = first; row + fit.rows() <= last; row += fit.step()) {
                const PulseFit::Result rest = fit.of(rest_, row);
                const PulseFit::Result found = smaller(fit.of(missed_, row), rest);
                const double start_s = signals_.measured.time_s[row + fit.beside()];
                pulses_.push_back({{std::abs(found.height) * std::sqrt(found.share), start_s,
                                    start_s + push_lengths_s[length]},
                                   length,
                                   row,
                                   found.height,
                                   rest.height});
            }
        }
    }

    StationaryContact contact_of(const StandPulse& pulse, const Holding& holding,
                                 double noise_variance) const {
        const double rigid = fits_[pulse.length].of(signals_.nominal.col(joint_), pulse.first).height;
        StationaryContact contact;
        contact.joint = static_cast<std::size_t>(joint_);
        contact.pulse = {pulse.start_s, pulse.end_s, push_flanks * (pulse.end_s - pulse.start_s)};
        contact.change = pulse.height;
        contact.change_deviation = height_deviation(pulses_, pulse.length);
        contact.noise = std::sqrt(2 * std::log(static_cast<double>(pulses_.size())) * noise_variance *
                                  fits_[pulse.length].variance());
        contact.held = 2 * holding.most;
        contact.held_deviation = std::hypot(2 * std::sqrt(holding.variance), uncertain_share * rigid);
        return contact;
    }

    const DiagnosisSignals& signals_;
    Eigen::Index joint_;
    Eigen::VectorXd missed_, rest_;
    std::vector<PulseFit> fits_;
    std::vector<StandPulse> pulses_;
    StandNoise noise_;
};

} // namespace

double StationaryContact::deviation() const { return std::hypot(change_deviation, held_deviation); }

double StationaryContact::probability() const {
    return std::erfc((held + noise - std::abs(change)) / (deviation() * std::numbers::sqrt2)) / 2;
}

std::vector<StationaryContact> stationary_contacts(const DiagnosisSignals& signals,
                                                   const FittedEffects& fitted_effects,
                                                   const Eigen::MatrixXd& measured,
                                                   const Eigen::MatrixXd& rest) {
    std::vector<StationaryContact> result;
    for (Eigen::Index joint = 0; !signals.wrench() && joint < signals.outputs(); ++joint) {
        const JointStands stands(signals, joint, measured.col(joint) - signals.nominal.col(joint),
                                 rest.col(joint));
        if (stands.none()) {
            continue;
        }
        const Holding holding = holding_at(signals, fitted_effects, joint);
        if (holding.known()) {
            std::ranges::move(stands.contacts(holding), std::back_inserter(result));
        }
    }
    return result;
}

} // namespace dfdyn::tools
