// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/name_bodies.hpp"

#include "tools/base/text/number.hpp"
#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/extension/joined_recording.hpp"
#include "tools/diagnosis/recordings/link_finding.hpp"
#include "tools/diagnosis/verdict/findings.hpp"
#include "tools/robot/firmware_chain.hpp"

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

/// Returns the confidence of a load, from its log-evidence. Without a load it was -14 to -7 in thirteen
/// recordings of a real arm, so that 8, which a load needs at least, is far from chance; half of it is
/// doubted for effects that no model here has.
double load_confidence(double margin) {
    constexpr double highest = 0.95;
    return std::min(highest, 1 / (1 + std::exp(4 - margin / 2)));
}

/// Names links and loads.
class BodyNamer {
  public:
    BodyNamer(DiagnosisWork& work, const SeveralRecordings& several, const std::vector<double>& ends_s,
              const ErrorReduction& reduction)
        : work_(work), signals_(*work.signals), several_(several), ends_s_(ends_s), reduction_(reduction) {}

    /// Names the links that all recordings support, and doubts other errors of links and payloads.
    void name_links() {
        const bool load_of_all = std::ranges::any_of(
            several_.answer.loads, [](const RecordingLoad& load) { return !load.recording; });
        std::erase_if(findings(), [&](const Finding& one) {
            return (is_link(one) && supported_link(one.where) != nullptr) || (load_of_all && is_load(one));
        });
        for (Finding& one : findings()) {
            if (is_link(one) || is_load(one)) {
                one.confidence = std::min(one.confidence, unlikely);
                one.evidence += " (all recordings together do not support it)";
            }
        }
        for (const ArmHypothesis& link : several_.answer.wrong_links) {
            add_link(link);
        }
    }

    /// Doubts loads that were taken up where a recording begins or ends: they differ between recordings, and
    /// the load of a recording is sought as such.
    void doubt_loads_at_borders() {
        constexpr double near_s = 2;
        for (Finding& one : findings()) {
            const bool taken = is_taken(one);
            const double time_s = taken ? one.parameters.back().value : 0;
            const auto border = std::ranges::find_if(ends_s_, [&](double end_s) {
                return time_s > end_s - near_s && time_s < end_s + joined_pause_s + near_s;
            });
            if (taken && border != ends_s_.end()) {
                one.confidence = std::min(one.confidence, unlikely);
                one.evidence += remark_at_border(static_cast<std::size_t>(border - ends_s_.begin()) + 1);
            }
        }
    }

    /// Names the loads of single recordings, and with `of_all` that of all.
    void name_loads(bool of_all) {
        for (const RecordingLoad& load : several_.answer.loads) {
            if (load.recording || of_all) {
                add_load(load);
            }
        }
    }

  private:
    std::vector<Finding>& findings() { return work_.diagnosis.findings; }
    const PooledFit& fit() const { return several_.answer.fit; }

    static bool is_link(const Finding& one) {
        const Effect* const effect = find_effect(one.effect);
        return effect != nullptr && effect->each == Each::body;
    }

    /// Returns whether a load was picked up on the way: its last parameter is the time.
    static bool is_taken(const Finding& one) {
        const Effect payload = effects::payload();
        return one.effect == payload.name && !one.parameters.empty() &&
               one.parameters.back().name == payload.parameters.back().name;
    }

    /// A load that was picked up on the way was no hypothesis.
    static bool is_load(const Finding& one) {
        return one.effect == effects::payload().name && !is_taken(one);
    }

    /// Describes a load that was taken up where recording `number` begins.
    std::string remark_at_border(std::size_t number) const {
        if (!several_.loads_differ) {
            return " (it begins where a recording does: --changed payload seeks such loads)";
        }
        const bool subtracted = std::ranges::any_of(several_.answer.loads, [&](const RecordingLoad& load) {
            return load.recording && several_.pooled[*load.recording] == number;
        });
        return std::string(" (it begins where a recording does, ") +
               (subtracted ? "besides the load that is subtracted from this recording)"
                           : "but all recordings together do not support a load of this recording)");
    }

    std::string place(Index body) const { return place_text(PlaceKind::link, signals_.link_of(body)); }

    const ArmHypothesis* supported_link(const std::string& where) const {
        const auto& links = several_.answer.wrong_links;
        const auto found = std::ranges::find_if(
            links, [&](const ArmHypothesis& one) { return place(*one.body) == where && mass_of(one) > 0; });
        return found == links.end() ? nullptr : &*found;
    }

    /// Returns the mass of a wrong link.
    double mass_of(const ArmHypothesis& link) const {
        return nominal_parameters(signals_.robot, signals_.kind)[10 * *link.body] +
               fit().value[10 * *link.body];
    }

    void add_link(const ArmHypothesis& link) {
        const Index first = 10 * *link.body;
        const InertialParameters nominal =
            nominal_parameters(signals_.robot, signals_.kind).segment<10>(first);
        const InertialParameters change = fit().value.segment<10>(first);
        if (!(mass_of(link) > 0)) {
            return; // no body has this mass
        }
        Finding finding = link_finding(nominal, change, fit().covariance.block<10, 10>(first, first));
        finding.where = place(*link.body);
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
        const Effect payload = effects::payload();
        finding.effect = payload.name;
        finding.where = "tool";
        finding.parameters =
            mass_and_centre(payload, InertialParameters::Zero(), load.parameters, load.covariance);
        finding.margin_to_nothing = load.margin;
        finding.confidence = load_confidence(load.margin);
        VectorXd there = VectorXd::Ones(signals_.rows());
        if (load.recording) {
            const std::size_t number = several_.pooled[*load.recording];
            finding.only_in = several_.names[number];
            finding.detail = "only in " + finding.only_in;
            there = rows_of(number);
            work_.diagnosis.suspicions.push_back({load_remark(finding)});
        }
        push(std::move(finding), there.asDiagonal() * signals_.of_body(last, load.of_body));
    }

    /// Returns 1 for the rows of a recording, 0 for the others.
    VectorXd rows_of(std::size_t number) const {
        const double start_s = number == 0 ? -std::numeric_limits<double>::infinity() : ends_s_[number - 1];
        const Eigen::ArrayXd time = signals_.measured.time_s.array();
        return (time > start_s && time <= ends_s_[number] + 1e-6).cast<double>();
    }

    static std::string load_remark(const Finding& load) {
        return "a load of " + rounded_text(load.parameters.front().value) +
               " kg, fitted to the whole recording, is subtracted from the outputs of " + load.only_in +
               ": errors, also those on held-out time, curves and the extended model are without it";
    }

    void push(Finding finding, const MatrixXd& share) {
        finding.margin_to_others = std::numeric_limits<double>::infinity();
        finding.confirm = confirmation(finding);
        reduction_.describe(finding, share);
        findings().push_back(std::move(finding));
    }

    DiagnosisWork& work_;
    const DiagnosisSignals& signals_;
    const SeveralRecordings& several_;
    const std::vector<double>& ends_s_;
    const ErrorReduction& reduction_;
};

} // namespace

void name_bodies(DiagnosisWork& work, const SeveralRecordings& several, const std::vector<double>& ends_s,
                 const ErrorReduction& reduction, bool fitted_everywhere) {
    BodyNamer namer(work, several, ends_s, reduction);
    namer.doubt_loads_at_borders();
    if (fitted_everywhere) {
        namer.name_links();
    }
    namer.name_loads(fitted_everywhere);
}

} // namespace dfdyn::tools
