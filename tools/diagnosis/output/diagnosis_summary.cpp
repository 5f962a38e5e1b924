// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/diagnosis_summary.hpp"

#include "tools/base/text/instant.hpp"
#include "tools/base/text/number.hpp"
#include "tools/diagnosis/output/finding_words.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <set>

namespace dfdyn::tools {

namespace {

constexpr std::size_t most_findings = 12; ///< lines on one screen
constexpr std::size_t most_experiments = 3;
constexpr double sure = 0.9;

void print_suspicions(std::ostream& out, const Diagnosis& diagnosis) {
    for (const Suspicion& suspicion : diagnosis.suspicions) {
        out << "! " << suspicion.words() << '\n';
    }
    if (!diagnosis.suspicions.empty()) {
        out << '\n';
    }
}

/// Returns the error without standstill as text; empty if the share of standstill is negligible.
std::string while_moving(const Diagnosis& diagnosis, Eigen::Index output) {
    if (!(diagnosis.standstill_share[output] > noticeable_standstill)) {
        return "";
    }
    const double nominal = diagnosis.nominal.moving_nrmse[output];
    return std::isnan(nominal) ? ", all of it at standstill"
                               : "; while it moves " + percent(nominal) + " -> " +
                                     percent(diagnosis.extended.moving_nrmse[output]);
}

void print_errors(std::ostream& out, const Diagnosis& diagnosis) {
    const bool held_out = has_held_out(diagnosis);
    out << "error, rms and share of the output's deviation, ";
    if (held_out) {
        out << "on held-out time (" << instant_text(diagnosis.heldout_from_s) << " to "
            << instant_text(diagnosis.heldout_to_s) << " fitted no effect):\n";
    } else {
        out << "over " << diagnosis.scope << ":\n";
    }
    for (std::size_t k = 0; k < diagnosis.output_names.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        const auto show = [&](const ErrorMeasure& error) {
            out << std::setw(9) << rounded_text(error.rms[row]) << " (" << std::setw(6)
                << percent(error.nrmse[row]) << ')';
        };
        out << "  " << std::left << std::setw(6) << diagnosis.output_names[k] << std::right;
        show(diagnosis.nominal);
        out << "  ->";
        show(diagnosis.extended);
        out << ' ' << diagnosis.output_units[k] << while_moving(diagnosis, row) << "; plain least squares "
            << percent(diagnosis.least_squares.nrmse[row]) << '\n';
    }
}

void print_finding(std::ostream& out, const Diagnosis& diagnosis, const Finding& finding) {
    const auto index = static_cast<std::size_t>(finding.output);
    const std::string& output = diagnosis.output_names[index];
    out << "  " << std::setw(6) << confidence_text(finding.confidence) << "  " << cause_words(finding)
        << ": ";
    const std::string parameter = main_parameter_words(finding);
    out << parameter << (parameter.empty() ? "" : ", ");
    out << output << " error " << rounded_text(finding.rms_before) << " -> "
        << rounded_text(finding.rms_after) << ' ' << diagnosis.torque_units[index] << '\n';
    if (!finding.by_recording.empty()) {
        const auto [least, most] = std::ranges::minmax(finding.by_recording, {}, &ValueOfRecording::value);
        out << "        in single recordings from " << rounded_text(least.value) << " to "
            << rounded_text(most.value) << " (" << most.recording << "), standard deviation "
            << rounded_text(finding.spread) << '\n';
    }
    if (!finding.indistinguishable.empty()) {
        out << "        this motion hardly distinguishes it from: " << tie_words(finding) << '\n';
    }
}

void print_findings(std::ostream& out, const Diagnosis& diagnosis) {
    const std::vector<Finding>& findings = diagnosis.findings;
    if (findings.empty()) {
        out << "no cause found\n";
        return;
    }
    std::vector<const Finding*> likely;
    std::string perhaps;
    for (const Finding& finding : findings) {
        if (finding.confidence >= likely_confidence) {
            likely.push_back(&finding);
        } else {
            perhaps.append(perhaps.empty() ? "" : "; ").append(cause_words(finding));
        }
    }
    out << (likely.empty()
                ? "no likely cause found\n"
                : "likely causes with their confidence, by the ratio of the errors without and with each:\n");
    for (std::size_t i = 0; i < std::min(likely.size(), most_findings); ++i) {
        print_finding(out, diagnosis, *likely[i]);
    }
    if (likely.size() > most_findings) {
        out << "  … and " << likely.size() - most_findings << " more in the report\n";
    }
    if (!perhaps.empty()) {
        out << "perhaps: " << perhaps << '\n';
    }
}

/// Returns whether a nuisance parameter differs noticeably from the value in the file.
bool is_new(const NuisanceEstimate& nuisance) {
    constexpr double noticeable = 0.01;
    return !nuisance.given || std::abs(nuisance.parameter.value / *nuisance.given - 1) > noticeable;
}

/// Prints all nuisance parameters with one name on one line.
void print_nuisances(std::ostream& out, const Diagnosis& diagnosis, const std::string& name,
                     const char* lead) {
    std::string list;
    for (const NuisanceEstimate& one : diagnosis.nuisance_estimates) {
        if (one.parameter.name == name && is_new(one)) {
            list.append(list.empty() ? "" : "; ").append(nuisance_words(one));
        }
    }
    if (!list.empty()) {
        out << lead << list << '\n';
    }
}

/// Prints the experiments for the findings with the lowest confidence.
void print_experiments(std::ostream& out, const Diagnosis& diagnosis) {
    std::vector<const Finding*> unsure;
    for (const Finding& finding : diagnosis.findings) {
        if (finding.confidence < sure || !finding.indistinguishable.empty()) {
            unsure.push_back(&finding);
        }
    }
    std::ranges::stable_sort(unsure, {}, [](const Finding* finding) { return finding->confidence; });
    unsure.resize(std::min(unsure.size(), most_experiments));
    for (const Finding* finding : unsure) {
        out << "to settle " << cause_words(*finding) << ": " << finding->confirm << '\n';
    }
}

void print_unexplained(std::ostream& out, const Diagnosis& diagnosis) {
    for (const Unexplained& entry : diagnosis.unexplained) {
        out << "unexplained: " << percent(entry.nrmse) << " of "
            << diagnosis.output_names[static_cast<std::size_t>(entry.output)] << " depends on ";
        for (std::size_t i = 0; i < entry.depends_on.size(); ++i) {
            out << (i == 0 ? "" : ", ") << entry.depends_on[i];
        }
        out << ": " << entry.note << '\n';
    }
}

/// Prints the findings with one disposition on one line, each once.
void print_not_whole(std::ostream& out, const std::vector<ExtendedFinding>& carried, ExtendedFinding::How how,
                     const char* lead) {
    std::set<std::string> told;
    std::string list;
    for (const ExtendedFinding& one : carried) {
        const std::string cause = cause_words(OtherCause{one.effect, one.where, {}});
        if (one.how == how && told.insert(cause).second) {
            list.append(list.empty() ? "" : "; ").append(cause);
        }
    }
    if (!list.empty()) {
        out << lead << list << '\n';
    }
}

void print_carried(std::ostream& out, const std::vector<ExtendedFinding>& carried) {
    print_not_whole(out, carried, ExtendedFinding::How::approximated,
                    "the extended model has, as Coulomb friction only: ");
    print_not_whole(out, carried, ExtendedFinding::How::left_out, "the extended model leaves out: ");
}

} // namespace

void print_diagnosis(std::ostream& out, const Diagnosis& diagnosis,
                     const std::vector<ExtendedFinding>& carried) {
    print_suspicions(out, diagnosis);
    if (diagnosis.nominal.rms.size() == 0) {
        return;
    }
    print_errors(out, diagnosis);
    print_findings(out, diagnosis);
    print_nuisances(out, diagnosis, "torque_constant", "torque constants, N·m/A: ");
    print_nuisances(out, diagnosis, "mass", "masses that fit better, none of which stands out, kg: ");
    print_experiments(out, diagnosis);
    print_unexplained(out, diagnosis);
    print_carried(out, carried);
}

} // namespace dfdyn::tools
