// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/arm_question.hpp"

#include "tools/diagnosis/candidates/point_mass.hpp"
#include "tools/diagnosis/effects/effect.hpp"
#include "tools/diagnosis/verdict/textbook.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/inertia.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double least_evidence = 8; ///< minimum log-evidence of a hypothesis

/// Expected spread of a term between recordings, as a share `part` of the term `of` of the same joint. For
/// friction these are the values of `textbook_findings`.
struct TermSpread {
    TextbookTerm of;
    double part;
};
TermSpread term_spread(TextbookTerm term) {
    switch (term) {
    case TextbookTerm::viscous:
        return {term, 0.15};
    case TextbookTerm::dry:
        return {term, 0.05};
    case TextbookTerm::offset:
        return {TextbookTerm::dry, 0.1};
    case TextbookTerm::gain:
    case TextbookTerm::inertia:
        break;
    }
    return {term, 0.15};
}

/// Minimum expected spread of a term, SI units. `joint_inertia`: mean inertia of the joint.
double least_spread(TextbookTerm term, double joint_inertia) {
    constexpr double gain_spread = 0.01, inertia_part = 0.1, least = 1e-3;
    switch (term) {
    case TextbookTerm::gain:
        return gain_spread;
    case TextbookTerm::inertia:
        return std::max(inertia_part * joint_inertia, 1e-6);
    case TextbookTerm::viscous:
    case TextbookTerm::dry:
    case TextbookTerm::offset:
        break;
    }
    return least;
}

/// Sets the prior of the terms of a joint. Groups of spreads: 0 for the links, 1 to 5 for the terms.
void set_terms(PooledPrior& prior, const DiagnosisSignals& signals, Index joint) {
    const double inertia = signals.joint_inertia.col(joint).mean();
    for (Index term = 0; term < terms_of_joint; ++term) {
        const auto kind = static_cast<TextbookTerm>(term);
        const Index at = first_term(signals, joint) + term;
        const auto number = static_cast<std::size_t>(at);
        const TermSpread spread = term_spread(kind);
        prior.covariance(at, at) = unknown_deviation * unknown_deviation;
        prior.relative_spread[at] = kind == TextbookTerm::gain ? 0 : spread.part;
        prior.least_spread[at] = least_spread(kind, inertia);
        prior.spread_of[number] = first_term(signals, joint) + static_cast<Index>(spread.of);
        prior.group[number] = term + 1;
    }
}

/// Returns the prior of an arm whose links may differ as in `fit_arm`, with unknown gains.
PooledPrior arm_prior(const DiagnosisSignals& signals, std::size_t recordings) {
    // spread between recordings that model errors cause, as a share of the links' deviations
    constexpr double link_spread = 0.3;
    const Index size = first_term(signals, signals.outputs());
    const VectorXd links = link_deviations(signals);
    PooledPrior prior;
    prior.covariance = MatrixXd::Zero(size, size);
    prior.covariance.diagonal().head(links.size()) = links.cwiseAbs2();
    prior.relative_spread = prior.least_spread = VectorXd::Zero(size);
    prior.least_spread.head(links.size()) = link_spread * links;
    prior.group.assign(static_cast<std::size_t>(size), 0);
    prior.spread_of.resize(static_cast<std::size_t>(size));
    std::iota(prior.spread_of.begin(), prior.spread_of.end(), Index{0});
    for (Index joint = 0; joint < signals.outputs(); ++joint) {
        set_terms(prior, signals, joint);
    }
    prior.changed.assign(recordings, MatrixXd::Zero(size, size));
    return prior;
}

/// Gives a gain the prior 1 ± `known_gain_deviation` unless the fit with unknown gains contradicts it.
void set_known_gains(PooledPrior& prior, const DiagnosisSignals& signals, const PooledFit& free) {
    for (Index joint = 0; joint < signals.outputs(); ++joint) {
        const Index at = first_term(signals, joint);
        const double variance = free.covariance(at, at) + free.spread[at] * free.spread[at];
        if (!contradicts_known_gain(1 + free.value[at], variance)) {
            prior.covariance(at, at) = known_gain_deviation * known_gain_deviation;
        }
    }
}

/// A load at the tip: the prior of its ten inertial parameters, and their transform to the last body's frame.
struct LoadModel {
    Eigen::Matrix<double, 10, 10> to_body; ///< from parameters at the tip
    Eigen::Matrix<double, 10, 1> variance; ///< prior variance of the parameters at the tip

    explicit LoadModel(const DiagnosisSignals& signals) {
        constexpr double mass_part = 0.2,
                         reach_m = 0.1; // standard deviations: share of the arm's mass, distance from the tip
        const VectorXd nominal = nominal_parameters(signals.robot, signals.kind);
        const double mass = mass_part * nominal(Eigen::seqN(0, nominal.size() / 10, 10)).sum();
        variance << 1, Eigen::Vector3d::Constant(reach_m * reach_m),
            Eigen::Matrix<double, 6, 1>::Constant(std::pow(reach_m, 4));
        variance *= mass * mass;
        for (Index k = 0; k < 10; ++k) {
            const InertialParameters unit = InertialParameters::Unit(k);
            to_body.col(k) = moved(unit, signals.robot.tip_placement);
        }
    }

    MatrixXd covariance() const { return to_body * variance.asDiagonal() * to_body.transpose(); }
};

/// Greedy forward selection of hypotheses by their evidence, followed by one backward pass.
class HypothesisSearch {
  public:
    HypothesisSearch(const DiagnosisSignals& signals, const std::vector<RecordingInformation>& recordings,
                     bool loads_differ, bool gains_known)
        : signals_(signals), recordings_(recordings), loads_differ_(loads_differ), load_(signals),
          prior_(arm_prior(signals, recordings.size())), fit_(pool(recordings, prior_)) {
        if (gains_known) {
            set_known_gains(prior_, signals, fit_);
            fit_ = pool(recordings, prior_, fit_.ratio);
        }
    }

    ArmAnswer answer() {
        const std::size_t most = recordings_.size() + 3;
        for (std::size_t found = 0; found < most; ++found) {
            std::optional<ArmHypothesis> best = best_hypothesis();
            if (!best) {
                break;
            }
            accept(prior_, *best);
            fit_ = pool(recordings_, prior_, fit_.ratio);
            accepted_.push_back(std::move(*best));
        }
        drop_explained();
        ArmAnswer answer;
        for (const ArmHypothesis& one : accepted_) {
            if (one.body) {
                answer.wrong_links.push_back(one);
            } else {
                answer.loads.push_back(load_of(one, prior_, fit_));
            }
        }
        answer.fit = std::move(fit_);
        return answer;
    }

  private:
    Index bodies() const { return signals_.regressor.cols() / 10; }

    /// Removes hypotheses that later ones explain, and computes the log-evidence of the others again.
    void drop_explained() {
        for (std::size_t i = 0; i < accepted_.size();) {
            PooledPrior without = prior_;
            accept(without, accepted_[i], -1);
            PooledFit fit = pool(recordings_, without, fit_.ratio);
            accepted_[i].margin = fit_.evidence - fit.evidence;
            if (accepted_[i].margin >= least_evidence) {
                ++i;
                continue;
            }
            prior_ = std::move(without);
            fit_ = std::move(fit);
            accepted_.erase(accepted_.begin() + static_cast<std::ptrdiff_t>(i));
        }
    }

    bool is_accepted(const ArmHypothesis& one) const {
        return std::ranges::any_of(accepted_, [&](const ArmHypothesis& other) {
            return one.body == other.body && one.recording == other.recording;
        });
    }

    /// Adds a hypothesis' variance to a prior; `sign` -1: subtracts it.
    void accept(PooledPrior& prior, const ArmHypothesis& one, double sign = 1) const {
        constexpr double wrong_link_factor = 4; // standard deviation, relative to the other links
        const Index first = 10 * one.body.value_or(bodies() - 1);
        MatrixXd& covariance = one.recording ? prior.changed[*one.recording] : prior.covariance;
        if (one.body) {
            const Eigen::Array<double, 10, 1> nominal_deviation =
                link_deviations(signals_).segment<10>(first).array();
            covariance.diagonal().segment<10>(first).array() +=
                sign * (wrong_link_factor * wrong_link_factor - 1) * nominal_deviation.square();
        } else {
            covariance.block<10, 10>(first, first) += sign * load_.covariance();
        }
    }

    std::vector<ArmHypothesis> all_hypotheses() const {
        std::vector<ArmHypothesis> all(1); // a load in all recordings
        for (Index body = 0; body < bodies(); ++body) {
            all.push_back({.body = body, .recording = {}, .others = {}});
        }
        for (std::size_t r = 0; loads_differ_ && r < recordings_.size(); ++r) {
            all.push_back({.body = {}, .recording = r, .others = {}});
        }
        return all;
    }

    /// Returns every hypothesis that is not accepted and physically possible, with its log-evidence.
    std::vector<ArmHypothesis> possible_hypotheses() const {
        std::vector<ArmHypothesis> possible;
        for (ArmHypothesis& one : all_hypotheses()) {
            if (is_accepted(one)) {
                continue;
            }
            PooledPrior prior = prior_;
            accept(prior, one);
            const PooledFit fit = pool(recordings_, prior, fit_.ratio);
            one.margin = fit.evidence - fit_.evidence;
            if (one.body || is_load(load_of(one, prior, fit).parameters)) {
                possible.push_back(std::move(one));
            }
        }
        return possible;
    }

    /// Returns whether these parameters at the tip describe a load: a positive mass, near enough to the tip.
    static bool is_load(const Eigen::Matrix<double, 10, 1>& parameters) {
        return parameters[0] > 0 && parameters.segment<3>(1).norm() <= farthest_payload * parameters[0];
    }

    std::optional<ArmHypothesis> best_hypothesis() const {
        constexpr double min_distinct_margin = 5; // log-evidence: odds of 150
        std::vector<ArmHypothesis> all = possible_hypotheses();
        std::ranges::stable_sort(all, std::ranges::greater(), &ArmHypothesis::margin);
        if (all.empty() || all.front().margin < least_evidence) {
            return std::nullopt;
        }
        ArmHypothesis best = std::move(all.front());
        for (std::size_t i = 1; best.body && i < all.size(); ++i) {
            if (all[i].body && all[i].margin > best.margin - min_distinct_margin) {
                best.others.push_back(*all[i].body);
            }
        }
        return best;
    }

    /// Returns the load's share of the last body's parameters; spread and errors of the link are the rest.
    /// `prior` includes the hypothesis, and `fit` is its fit.
    RecordingLoad load_of(const ArmHypothesis& one, const PooledPrior& prior, const PooledFit& fit) const {
        const Index last = 10 * (bodies() - 1);
        const Eigen::Matrix<double, 10, 10> part = load_.variance.asDiagonal() * load_.to_body.transpose();
        const std::size_t r = one.recording.value_or(0);
        MatrixXd total = (one.recording ? prior.changed[r] : prior.covariance).block<10, 10>(last, last);
        total.diagonal() += (one.recording ? 1.0 : 0.0) * fit.spread.segment<10>(last).cwiseAbs2();
        const Eigen::LLT<MatrixXd> factor(total);
        const MatrixXd gain = factor.solve(part.transpose()).transpose();
        const VectorXd& found = one.recording ? fit.difference[r] : fit.value;
        const MatrixXd& uncertain = one.recording ? fit.difference_covariance[r] : fit.covariance;
        RecordingLoad load{one.recording, one.margin, gain * found.segment<10>(last), {}, {}};
        load.covariance = MatrixXd(load_.variance.asDiagonal()) - gain * part.transpose() +
                          gain * uncertain.block<10, 10>(last, last) * gain.transpose();
        load.of_body = load_.to_body * load.parameters;
        return load;
    }

    const DiagnosisSignals& signals_;
    const std::vector<RecordingInformation>& recordings_;
    bool loads_differ_;
    LoadModel load_;
    PooledPrior prior_;
    PooledFit fit_;
    std::vector<ArmHypothesis> accepted_;
};

} // namespace

ArmAnswer ask_recordings(const DiagnosisSignals& signals, const std::vector<RecordingInformation>& recordings,
                         bool loads_differ, bool gains_known) {
    return HypothesisSearch(signals, recordings, loads_differ, gains_known).answer();
}

} // namespace dfdyn::tools
