// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/name_from_recordings.hpp"

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/joined_recording.hpp"
#include "tools/diagnosis/recordings/consistency.hpp"
#include "tools/diagnosis/recordings/name_bodies.hpp"
#include "tools/diagnosis/verdict/error_reduction.hpp"
#include "tools/diagnosis/verdict/findings.hpp"
#include "tools/diagnosis/verdict/found_parameters.hpp"
#include "tools/diagnosis/verdict/joint_units.hpp"
#include "tools/diagnosis/verdict/textbook.hpp"
#include "tools/diagnosis/verdict/textbook_findings.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Makes findings of the joints' terms in the pooled fit, with their contributions to the joined recording.
class TermNamer {
  public:
    TermNamer(DiagnosisWork& work, const SeveralRecordings& several)
        : work_(work), signals_(*work.signals), several_(several), everywhere_(friction_everywhere(work)),
          rest_(everywhere_ ? rest_of_pooled() : work.rest),
          reduction_(signals_, rest_, work.diagnosis.output_names) {}

    bool everywhere() const { return everywhere_; }
    const ErrorReduction& reduction() const { return reduction_; }

    /// Replaces the findings at a joint (friction everywhere), or adds the pooled values to them.
    void name_terms(std::size_t joint) {
        const std::string where = place_text(PlaceKind::joint, joint);
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

    /// Columns (T x 5) of a joint's terms in the joined recording.
    MatrixXd columns(Index joint) const {
        return textbook_columns(signals_, signals_.nominal.col(joint), joint);
    }

    /// Returns the residual of the joined recording's torques with the pooled values.
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
        constexpr double clear = 3; // standard deviations by which a value differs significantly from zero
        const ParameterKind& kind = effect.parameters.front();
        Finding finding;
        finding.effect = effect.name;
        finding.where = place_text(PlaceKind::joint, joint);
        finding.spread = fit().spread[at];
        const double of_recording = std::hypot(deviation, finding.spread);
        if (!effect.friction && everywhere_ && std::abs(value) < of_recording) {
            return; // noise
        }
        finding.parameters = {parameter_within(kind.name, kind.unit, value, of_recording)};
        finding.confidence = probability_of_size(value, of_recording);
        if (!effect.friction && std::abs(value) < clear * deviation) {
            finding.confidence = std::min(finding.confidence, unlikely);
        }
        finding.margin_to_nothing = 0.5 * std::pow(value / deviation, 2);
        finding.margin_to_others = std::numeric_limits<double>::infinity();
        finding.by_recording = values_of(at);
        finding.confirm = confirmation(finding);
        MatrixXd share = MatrixXd::Zero(signals_.rows(), signals_.outputs());
        share.col(output) = value * columns(output).col(term);
        reduction_.describe(finding, share);
        if (reduces_error(finding) || !everywhere_) {
            better.push_back(std::move(finding));
        }
    }

    /// Returns the values of an unknown in the pooled recordings.
    std::vector<ValueOfRecording> values_of(Index at) const {
        std::vector<ValueOfRecording> values;
        for (std::size_t r = 0; r < several_.pooled.size(); ++r) {
            const double value = fit().value[at] + fit().difference[r][at];
            const FoundParameter own = parameter_within({}, {}, value, fit().own_deviation[r][at]);
            values.push_back({several_.names[several_.pooled[r]], own.value, own.low, own.high});
        }
        return values;
    }

    /// Gives a finding of the joined recording the pooled value, unless its output has a likely cause that
    /// the pooled model does not contain.
    void complete(Finding& old, const Finding& pooled) {
        const bool other_cause = std::ranges::any_of(findings(), [&](const Finding& one) {
            return one.output == old.output && one.confidence > unlikely && !has_textbook_term(one.effect);
        });
        if (!other_cause) {
            old.parameters = pooled.parameters;
            old.spread = pooled.spread;
            old.by_recording = pooled.by_recording;
            old.confidence = std::min(old.confidence, pooled.confidence);
        }
    }

    DiagnosisWork& work_;
    const DiagnosisSignals& signals_;
    const SeveralRecordings& several_;
    bool everywhere_;
    MatrixXd rest_; ///< T x n
    ErrorReduction reduction_;
};

/// Adds a suspicion for each recording without rows in the joined one, or without a part in the fit.
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
                      ? " has longer time steps than the others: it contributes to the common values, but no "
                        "cause was sought in it"
                      : " has no two seconds without a gap, or its rows are more than 0.2 s apart: it "
                        "does not contribute to the common values")});
        }
        before = end;
    }
}

} // namespace

void name_from_recordings(DiagnosisWork& work, const Robot& robot, const SeveralRecordings& several,
                          const std::vector<Recording>& recordings) {
    if (!several.fitted() || !effects_fitted(work)) {
        return;
    }
    work.diagnosis.recordings = several.names;
    const std::vector<double> ends_s = ends_in_joined(recordings);
    TermNamer namer(work, several);
    for (std::size_t joint = 0; joint < work.signals->joints(); ++joint) {
        namer.name_terms(joint);
    }
    name_bodies(work, several, ends_s, namer.reduction(), namer.everywhere());
    add_missing(work.diagnosis, work.signals->measured.time_s, several, ends_s);
    doubt_contradicted_findings(work, ends_s);
    sort_by_reduction(work.diagnosis.findings);
    use_units_of_joints(work.diagnosis, robot);
    doubt_useless_findings(work.diagnosis);
}

} // namespace dfdyn::tools
