// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/name_from_recordings.hpp"

#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/joined_recording.hpp"
#include "tools/diagnosis/recordings/consistency.hpp"
#include "tools/diagnosis/verdict/finding_gain.hpp"
#include "tools/diagnosis/verdict/findings.hpp"
#include "tools/diagnosis/verdict/found_parameters.hpp"
#include "tools/diagnosis/verdict/joint_units.hpp"
#include "tools/diagnosis/verdict/textbook.hpp"
#include "tools/diagnosis/verdict/textbook_findings.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

FoundParameter within(std::string name, std::string unit, double value, double deviation) {
    const double reach = deviations_of_95 * deviation;
    return {std::move(name), std::move(unit), value, value - reach, value + reach};
}

/// Returns the confidence of a load, from its log-evidence. Without a load it was -14 to -7 in thirteen
/// recordings of a real arm, so that 8, which a load needs at least, is far from chance; half of it is
/// doubted for effects that no model here has.
double load_confidence(double margin) {
    constexpr double highest = 0.95;
    return std::min(highest, 1 / (1 + std::exp(4 - margin / 2)));
}

/// Turns the answer of several recordings into findings, whose contributions are those in the joined
/// recording.
class Namer {
  public:
    Namer(DiagnosisWork& work, const SeveralRecordings& several, const std::vector<double>& ends_s)
        : work_(work), signals_(*work.signals), several_(several), ends_s_(ends_s),
          everywhere_(friction_everywhere(work)), rest_(everywhere_ ? rest_of_pooled() : work.rest),
          gains_(signals_, rest_, work.diagnosis.output_names) {}

    bool everywhere() const { return everywhere_; }

    /// Replaces or completes the findings at a joint.
    void name_terms(std::size_t joint) {
        const std::string where = numbered("joint", joint);
        std::vector<Finding> better;
        for (const Effect& effect : effect_catalogue()) {
            if (effect.textbook && (everywhere_ || is_found(effect.name, where))) {
                add_term(better, effect, joint);
            }
        }
        if (everywhere_) {
            std::erase_if(findings(), [&](const Finding& one) {
                return one.where == where && has_textbook_term(one.effect);
            });
            std::ranges::move(better, std::back_inserter(findings()));
            return;
        }
        for (Finding& one : better) {
            const auto old = std::ranges::find_if(findings(), [&](const Finding& other) {
                return other.effect == one.effect && other.where == where;
            });
            complete(*old, one);
        }
    }

    /// Names the links that all recordings support, and doubts other errors of links and payloads.
    void name_links() {
        std::erase_if(findings(), [&](const Finding& one) { return supported_link(one.where) != nullptr; });
        for (Finding& one : findings()) {
            if (one.effect == effects::link_inertia_error().name || one.effect == effects::payload().name) {
                one.confidence = std::min(one.confidence, unlikely);
                one.evidence += " (all recordings together do not support it)";
            }
        }
        for (const ArmHypothesis& link : several_.answer.wrong_links) {
            add_link(link);
        }
    }

    void name_loads() {
        for (const RecordingLoad& load : several_.answer.loads) {
            add_load(load);
        }
    }

  private:
    std::vector<Finding>& findings() { return work_.diagnosis.findings; }
    const PooledFit& fit() const { return several_.answer.fit; }

    static bool has_textbook_term(const std::string& effect) {
        const Effect* const found = find_effect(effect);
        return found != nullptr && found->textbook;
    }

    bool is_found(const char* effect, const std::string& where) {
        return std::ranges::any_of(
            findings(), [&](const Finding& one) { return one.effect == effect && one.where == where; });
    }

    std::string place(Index body) const {
        const Index unseen = std::ssize(signals_.robot.joints) - signals_.regressor.cols() / 10;
        return numbered("link", static_cast<std::size_t>(unseen + body));
    }

    const ArmHypothesis* supported_link(const std::string& where) const {
        const auto& links = several_.answer.wrong_links;
        const auto found =
            std::ranges::find_if(links, [&](const ArmHypothesis& one) { return place(*one.body) == where; });
        return found == links.end() ? nullptr : &*found;
    }

    /// Columns (T x 5) of a joint's terms in the joined recording.
    MatrixXd columns(Index joint) const {
        return fit_moving_rows(signals_, work_.measured.col(joint), signals_.nominal.col(joint), joint, true)
            .columns;
    }

    /// Returns what the pooled values leave of the joined recording's torques.
    MatrixXd rest_of_pooled() const {
        MatrixXd rest = work_.measured - signals_.nominal;
        for (Index body = 0; body < signals_.regressor.cols() / 10; ++body) {
            rest -= signals_.of_body(body, fit().value.segment<10>(10 * body));
        }
        for (Index joint = 0; joint < rest.cols(); ++joint) {
            rest.col(joint) -=
                columns(joint) * fit().value.segment<terms_of_joint>(first_term(signals_, joint));
        }
        for (const StationaryContact& push : work_.pushes) {
            rest.col(static_cast<Index>(push.joint)) -= push.share;
        }
        return rest;
    }

    void add_term(std::vector<Finding>& better, const Effect& effect, std::size_t joint) const {
        const auto output = static_cast<Index>(joint);
        const auto term = static_cast<Index>(*effect.textbook);
        const Index at = first_term(signals_, output) + term;
        const double value = fit().value[at];
        const double deviation = std::sqrt(fit().covariance(at, at));
        if (signals_.hardly_moves(joint) || (effect.textbook != TextbookTerm::offset && value <= 0)) {
            return;
        }
        constexpr double clear = 3; // standard deviations of a value that is not zero
        const ParameterKind& kind = effect.parameters.front();
        Finding finding;
        finding.effect = effect.name;
        finding.where = numbered("joint", joint);
        finding.spread = fit().spread[at];
        finding.parameters = {within(kind.name, kind.unit, value, std::hypot(deviation, finding.spread))};
        finding.confidence = probability_of_size(value, std::hypot(deviation, finding.spread));
        if (!effect.friction && std::abs(value) < clear * deviation) {
            finding.confidence = std::min(finding.confidence, unlikely);
        }
        finding.margin_to_nothing = 0.5 * std::pow(value / deviation, 2);
        finding.margin_to_others = std::numeric_limits<double>::infinity();
        finding.by_recording = values_of(at);
        finding.confirm = confirmation(finding);
        MatrixXd share = MatrixXd::Zero(signals_.rows(), signals_.outputs());
        share.col(output) = value * columns(output).col(term);
        if (gains_.tell(finding, share) || !everywhere_) {
            better.push_back(std::move(finding));
        }
    }

    /// Returns the values of an unknown in each recording.
    std::vector<ValueOfRecording> values_of(Index at) const {
        std::vector<ValueOfRecording> values;
        for (std::size_t r = 0; r < several_.pooled.size(); ++r) {
            const double value = fit().value[at] + fit().difference[r][at];
            const FoundParameter own = within({}, {}, value, fit().own_deviation[r][at]);
            values.push_back({several_.names[several_.pooled[r]], own.value, own.low, own.high});
        }
        return values;
    }

    /// Gives a finding of the joined recording the value of all recordings, unless another friction at that
    /// joint makes the pooled model wrong there.
    void complete(Finding& old, const Finding& pooled) {
        const bool other_friction = std::ranges::any_of(findings(), [&](const Finding& one) {
            return one.where == old.where && has_trait(one.effect, &Effect::friction) &&
                   !has_textbook_term(one.effect);
        });
        if (!other_friction) {
            old.parameters = pooled.parameters;
            old.spread = pooled.spread;
            old.by_recording = pooled.by_recording;
        }
    }

    void add_link(const ArmHypothesis& link) {
        const Index first = 10 * *link.body;
        const VectorXd nominal = nominal_parameters(signals_.robot, signals_.kind).segment<10>(first);
        const Eigen::Matrix<double, 10, 1> change = fit().value.segment<10>(first);
        const double mass = nominal[0] + change[0];
        if (!(mass > 0)) {
            return; // no body has this mass
        }
        Finding finding;
        finding.effect = effects::link_inertia_error().name;
        finding.where = place(*link.body);
        add_mass_and_centre(finding, {"delta_mass", "delta_com_x", "delta_com_y", "delta_com_z"}, change,
                            fit().covariance.block<10, 10>(first, first), nominal);
        finding.margin_to_nothing = link.margin;
        finding.confidence = calibrated_confidence(finding, several_.seconds);
        for (const Index other : link.others) {
            finding.indistinguishable.push_back({finding.effect, place(other), {}});
        }
        push(std::move(finding), signals_.of_body(*link.body, change));
    }

    void add_load(const RecordingLoad& load) {
        const Index last = signals_.regressor.cols() / 10 - 1;
        Finding finding;
        finding.effect = effects::payload().name;
        finding.where = "tool";
        finding.only_in = several_.names[several_.pooled[load.recording]];
        finding.detail = "only in " + finding.only_in;
        add_mass_and_centre(finding, {"mass", "com_x", "com_y", "com_z"}, load.parameters, load.covariance,
                            VectorXd::Zero(10));
        finding.margin_to_nothing = load.margin;
        const std::size_t number = several_.pooled[load.recording];
        const double start_s = number == 0 ? -std::numeric_limits<double>::infinity() : ends_s_[number - 1];
        const Eigen::ArrayXd time = signals_.measured.time_s.array();
        const VectorXd there = (time > start_s && time <= ends_s_[number] + 1e-6).cast<double>();
        finding.confidence = load_confidence(load.margin);
        push(std::move(finding), there.asDiagonal() * signals_.of_body(last, load.of_body));
    }

    /// Adds mass and centre of mass of a body that changes by `change`, as differences from `nominal`.
    static void add_mass_and_centre(Finding& finding, const std::array<const char*, 4>& names,
                                    const Eigen::Matrix<double, 10, 1>& change,
                                    const Eigen::Matrix<double, 10, 10>& covariance,
                                    const VectorXd& nominal) {
        const double mass = nominal[0] + change[0];
        finding.parameters = {within(names[0], "kg", change[0], std::sqrt(covariance(0, 0)))};
        for (Index axis = 1; axis <= 3; ++axis) {
            const double centre = (nominal[axis] + change[axis]) / mass;
            const double before = nominal[0] > 0 ? nominal[axis] / nominal[0] : 0;
            Eigen::Vector2d slope(-centre / mass, 1 / mass); // by mass and first moment
            const std::array<Index, 2> both{0, axis};
            const double variance = slope.dot(covariance(both, both) * slope);
            finding.parameters.push_back(within(names[static_cast<std::size_t>(axis)], "m", centre - before,
                                                std::sqrt(std::max(0.0, variance))));
        }
    }

    void push(Finding finding, const MatrixXd& share) {
        finding.margin_to_others = std::numeric_limits<double>::infinity();
        finding.confirm = confirmation(finding);
        gains_.tell(finding, share);
        findings().push_back(std::move(finding));
    }

    DiagnosisWork& work_;
    const DiagnosisSignals& signals_;
    const SeveralRecordings& several_;
    const std::vector<double>& ends_s_;
    bool everywhere_;
    MatrixXd rest_; ///< T x n
    Gains gains_;
};

/// Adds which recordings are not in the joined one, whose steps of time are those of most rows, or not in the
/// fit.
void add_missing(Diagnosis& diagnosis, const Eigen::VectorXd& time_s, const SeveralRecordings& several,
                 const std::vector<double>& ends_s) {
    Index before = 0;
    for (std::size_t r = 0; r < ends_s.size(); ++r) {
        const Index end = (time_s.array() <= ends_s[r] + 1e-6).count();
        const bool fitted = std::ranges::find(several.pooled, r) != several.pooled.end();
        if (end == before || !fitted) {
            diagnosis.suspicions.push_back(
                {several.names[r] +
                 (fitted
                      ? " has longer time steps than the others: it is in the values of all recordings, but "
                        "no cause was sought in it"
                      : " has no two seconds without a gap, and is in no value of all recordings")});
        }
        before = end;
    }
}

} // namespace

void name_from_recordings(DiagnosisWork& work, const Robot& robot, const SeveralRecordings& several,
                          const std::vector<Recording>& recordings) {
    if (!several.answered() || !answered(work)) {
        return;
    }
    work.diagnosis.recordings = several.names;
    const std::vector<double> ends_s = ends_in_joined(recordings);
    Namer namer(work, several, ends_s);
    for (std::size_t joint = 0; joint < work.signals->joints(); ++joint) {
        namer.name_terms(joint);
    }
    if (namer.everywhere()) {
        namer.name_links();
    }
    namer.name_loads();
    add_missing(work.diagnosis, work.signals->measured.time_s, several, ends_s);
    doubt_contradicted_findings(work, ends_s);
    sort_by_gain(work.diagnosis.findings);
    use_units_of_joints(work.diagnosis, robot);
    doubt_useless_findings(work.diagnosis);
}

} // namespace dfdyn::tools
