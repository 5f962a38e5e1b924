// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/arm_question.hpp"

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

constexpr double least_evidence = 8; ///< of a hypothesis

/// Expected spread of a term between recordings: part of the size of a term of the same joint. Those of
/// friction are the ones of single recordings (`textbook_findings`).
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

/// Least expected spread of a term, SI units. `joint_inertia`: mean inertia of the joint.
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

/// Sets the prior of the terms of a joint. Groups of spreads: 0 has the links, 1 to 5 the terms.
void set_terms(PooledPrior& prior, const DiagnosisSignals& signals, Index joint, bool gains_known) {
    const double inertia = signals.joint_inertia.col(joint).mean();
    for (Index term = 0; term < terms_of_joint; ++term) {
        const auto kind = static_cast<TextbookTerm>(term);
        const Index at = first_term(signals, joint) + term;
        const auto number = static_cast<std::size_t>(at);
        const TermSpread spread = term_spread(kind);
        const bool known = kind == TextbookTerm::gain && gains_known;
        prior.covariance(at, at) = std::pow(known ? known_gain_deviation : unknown_deviation, 2);
        prior.relative_spread[at] = kind == TextbookTerm::gain ? 0 : spread.part;
        prior.least_spread[at] = least_spread(kind, inertia);
        prior.spread_of[number] = first_term(signals, joint) + static_cast<Index>(spread.of);
        prior.group[number] = term + 1;
    }
}

/// Returns the prior of an arm whose links may differ as in `fit_arm`.
PooledPrior arm_prior(const DiagnosisSignals& signals, std::size_t recordings, const Changed& changed,
                      bool gains_known) {
    constexpr double link_spread =
        0.3; // of the links' deviations: what model errors look like in a recording
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
    MatrixXd differs = MatrixXd::Zero(size, size);
    for (Index joint = 0; joint < signals.outputs(); ++joint) {
        set_terms(prior, signals, joint, gains_known);
        for (std::size_t term = 0; term < changed.terms.size(); ++term) {
            const Index at = first_term(signals, joint) + static_cast<Index>(term);
            differs(at, at) = changed.terms[term] ? unknown_deviation * unknown_deviation : 0;
        }
    }
    prior.changed.assign(recordings, differs);
    return prior;
}

/// A load at the tip: ten inertial parameters there, and what they are in the last body's frame.
struct LoadModel {
    Eigen::Matrix<double, 10, 10> to_body; ///< from parameters at the tip
    Eigen::Matrix<double, 10, 1> variance; ///< of the parameters at the tip, before the recordings

    explicit LoadModel(const DiagnosisSignals& signals) {
        constexpr double mass_part = 0.2, reach_m = 0.1; // of the arm's mass, and from the tip
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

/// Chooses hypotheses by evidence, one after the other.
class HypothesisSearch {
  public:
    HypothesisSearch(const DiagnosisSignals& signals, const std::vector<RecordingInformation>& recordings,
                     const Changed& changed, bool gains_known)
        : signals_(signals), recordings_(recordings), changed_(changed), load_(signals),
          prior_(arm_prior(signals, recordings.size(), changed, gains_known)),
          fit_(pool(recordings, prior_)) {}

    ArmAnswer answer() {
        const std::size_t most = recordings_.size() + 2;
        for (std::size_t found = 0; found < most; ++found) {
            std::optional<ArmHypothesis> best = best_hypothesis();
            if (!best) {
                break;
            }
            accept(prior_, *best);
            fit_ = pool(recordings_, prior_, fit_.ratio);
            accepted_.push_back(std::move(*best));
        }
        ArmAnswer answer;
        for (const ArmHypothesis& one : accepted_) {
            if (one.recording) {
                answer.loads.push_back(load_of(one));
            } else {
                answer.wrong_links.push_back(one);
            }
        }
        answer.fit = std::move(fit_);
        return answer;
    }

  private:
    Index bodies() const { return signals_.regressor.cols() / 10; }

    bool is_accepted(const ArmHypothesis& one) const {
        return std::ranges::any_of(accepted_, [&](const ArmHypothesis& other) {
            return one.body == other.body && one.recording == other.recording;
        });
    }

    void accept(PooledPrior& prior, const ArmHypothesis& one) const {
        constexpr double wider = 4; // standard deviation of a wrong link, over that of the others
        if (one.body) {
            prior.covariance.block<10, 10>(10 * *one.body, 10 * *one.body) *= wider * wider;
        } else {
            const Index last = 10 * (bodies() - 1);
            prior.changed[*one.recording].block<10, 10>(last, last) += load_.covariance();
        }
    }

    /// Returns every hypothesis with its evidence.
    std::vector<ArmHypothesis> tried() const {
        std::vector<ArmHypothesis> all;
        for (Index body = 0; body < bodies(); ++body) {
            all.push_back({.body = body, .recording = {}, .others = {}});
        }
        for (std::size_t r = 0; changed_.payload && r < recordings_.size(); ++r) {
            all.push_back({.body = {}, .recording = r, .others = {}});
        }
        std::erase_if(all, [&](const ArmHypothesis& one) { return is_accepted(one); });
        for (ArmHypothesis& one : all) {
            PooledPrior prior = prior_;
            accept(prior, one);
            one.margin = pool(recordings_, prior, fit_.ratio).evidence - fit_.evidence;
        }
        return all;
    }

    std::optional<ArmHypothesis> best_hypothesis() const {
        constexpr double tie = 5; // log-evidence: odds of 150
        std::vector<ArmHypothesis> all = tried();
        std::ranges::stable_sort(all, std::ranges::greater(), &ArmHypothesis::margin);
        if (all.empty() || all.front().margin < least_evidence) {
            return std::nullopt;
        }
        ArmHypothesis best = std::move(all.front());
        for (std::size_t i = 1; best.body && i < all.size(); ++i) {
            if (all[i].body && all[i].margin > best.margin - tie) {
                best.others.push_back(*all[i].body);
            }
        }
        return best;
    }

    /// Returns the part of a recording's difference at the last body that is a load, not spread.
    RecordingLoad load_of(const ArmHypothesis& one) const {
        const std::size_t r = *one.recording;
        const Index last = 10 * (bodies() - 1);
        const Eigen::Matrix<double, 10, 10> part = load_.variance.asDiagonal() * load_.to_body.transpose();
        MatrixXd total = load_.covariance();
        total.diagonal() += fit_.spread.segment<10>(last).cwiseAbs2();
        const Eigen::LLT<MatrixXd> factor(total);
        const MatrixXd gain = factor.solve(part.transpose()).transpose();
        RecordingLoad load{r, one.margin, gain * fit_.difference[r].segment<10>(last), {}, {}};
        load.covariance = MatrixXd(load_.variance.asDiagonal()) - gain * part.transpose() +
                          gain * fit_.difference_covariance[r].block<10, 10>(last, last) * gain.transpose();
        load.of_body = load_.to_body * load.parameters;
        return load;
    }

    const DiagnosisSignals& signals_;
    const std::vector<RecordingInformation>& recordings_;
    const Changed& changed_;
    LoadModel load_;
    PooledPrior prior_;
    PooledFit fit_;
    std::vector<ArmHypothesis> accepted_;
};

} // namespace

ArmAnswer ask_recordings(const DiagnosisSignals& signals, const std::vector<RecordingInformation>& recordings,
                         const Changed& changed, bool gains_known) {
    return HypothesisSearch(signals, recordings, changed, gains_known).answer();
}

} // namespace dfdyn::tools
