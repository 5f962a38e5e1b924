// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/diagnosis_page.hpp"

#include "tools/base/text/instant.hpp"
#include "tools/base/text/number.hpp"
#include "tools/build_flags.hpp"
#include "tools/diagnosis/output/error_sections.hpp"
#include "tools/diagnosis/output/finding_section.hpp"
#include "tools/diagnosis/output/finding_words.hpp"
#include "tools/report/figure_page.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

namespace dfdyn::tools {

namespace {

std::string recording_names(const std::vector<Recording>& recordings) {
    std::string names;
    for (const Recording& recording : recordings) {
        names.append(names.empty() ? "" : ", ")
            .append(std::filesystem::path(recording.source).filename().string());
    }
    return names;
}

/// Returns the output with the largest error relative to its standard deviation.
Eigen::Index worst_output(const ErrorMeasure& error) {
    Eigen::Index worst = 0;
    error.nrmse.maxCoeff(&worst);
    return worst;
}

std::string errors_sentence(const DiagnosisCase& one) {
    const Diagnosis& diagnosis = one.work.diagnosis;
    const Eigen::Index worst = worst_output(diagnosis.nominal);
    const std::string& name = diagnosis.output_names[static_cast<std::size_t>(worst)];
    return std::string("The rigid body of ")
        .append(one.robot.name)
        .append(" misses what was measured in ")
        .append(recording_names(one.recordings))
        .append(" by ")
        .append(percent(diagnosis.nominal.nrmse.minCoeff()))
        .append(" to ")
        .append(percent(diagnosis.nominal.nrmse.maxCoeff()))
        .append(" of the outputs' deviation, most on ")
        .append(name)
        .append(" (")
        .append(rounded_text(diagnosis.nominal.rms[worst]))
        .append(" ")
        .append(diagnosis.output_units[static_cast<std::size_t>(worst)])
        .append(" rms).");
}

std::string causes_sentence(const Diagnosis& diagnosis) {
    if (diagnosis.findings.empty()) {
        return "No cause of the catalogue is needed to explain that: what is left looks like noise, or has "
               "no "
               "name.";
    }
    const auto is_likely = [](const Finding& finding) { return finding.confidence >= likely_confidence; };
    const auto likely = std::ranges::count_if(diagnosis.findings, is_likely);
    const auto perhaps = std::ssize(diagnosis.findings) - likely;
    const auto found = std::ranges::find_if(diagnosis.findings, is_likely);
    const Finding& first = found == diagnosis.findings.end() ? diagnosis.findings.front() : *found;
    const std::string parameter = main_parameter_words(first);
    std::string text = std::to_string(likely);
    return text.append(likely == 1 ? " cause is likely" : " causes are likely")
        .append(perhaps == 0 ? "" : ", " + std::to_string(perhaps) + " more possible")
        .append(", first of all ")
        .append(cause_words(first))
        .append(parameter.empty() ? "" : " (" + parameter + ")")
        .append(", with confidence ")
        .append(confidence_text(first.confidence))
        .append(".");
}

std::string gain_sentence(const Diagnosis& diagnosis) {
    if (!has_held_out(diagnosis)) {
        return "The error on held-out time was not measured.";
    }
    const Eigen::Index worst = worst_output(diagnosis.nominal);
    const double before = diagnosis.nominal.rms[worst];
    const double after = diagnosis.extended.rms[worst];
    return std::string("On time that fitted no effect, the error with them is ")
        .append(percent(diagnosis.extended.nrmse.minCoeff()))
        .append(" to ")
        .append(percent(diagnosis.extended.nrmse.maxCoeff()))
        .append(" of the outputs' deviation; on ")
        .append(diagnosis.output_names[static_cast<std::size_t>(worst)])
        .append(after < before   ? " it falls from "
                : after > before ? " it rises from "
                                 : " it stays from ")
        .append(rounded_text(before))
        .append(" to ")
        .append(rounded_text(after))
        .append(" ")
        .append(diagnosis.output_units[static_cast<std::size_t>(worst)])
        .append(" rms.");
}

/// Returns a summary of three sentences.
std::string summary(const DiagnosisCase& one) {
    const Diagnosis& diagnosis = one.work.diagnosis;
    if (diagnosis.nominal.rms.size() == 0 || one.work.fitted_effects.candidates.empty()) {
        return "The recording " + recording_names(one.recordings) +
               " cannot answer what the simulation gets wrong. The reasons are below. No cause is named, and "
               "there is no extended model.";
    }
    return errors_sentence(one) + " " + causes_sentence(diagnosis) + " " + gain_sentence(diagnosis);
}

PageSection suspicion_section(const Diagnosis& diagnosis) {
    PageSection section{"First of all: is the recording what it should be?", {}, {}, {}};
    for (const Suspicion& suspicion : diagnosis.suspicions) {
        section.paragraphs.push_back("Suspicion: " + suspicion.words() + ".");
    }
    return section;
}

/// Adds a column with the errors without standstill.
void add_moving_errors(ReportTable& table, const Diagnosis& diagnosis) {
    table.columns.push_back("while it moves");
    table.note +=
        " While it moves: without the rows where the output's joint is at rest. Its friction can have "
        "any value below the dry friction there, which the motion does not determine.";
    for (std::size_t k = 0; k < table.rows.size(); ++k) {
        const auto output = static_cast<Eigen::Index>(k);
        const double nominal = diagnosis.nominal.moving_nrmse[output];
        table.rows[k].push_back(std::isnan(nominal) ? std::string("not in this time")
                                                    : percent(nominal) + " → " +
                                                          percent(diagnosis.extended.moving_nrmse[output]));
    }
}

ReportTable error_table(const Diagnosis& diagnosis) {
    ReportTable table{"Error per output",
                      {"output", "unit", "simulated, rms", "of deviation", "extended, rms", "of deviation ",
                       "plain least squares, of deviation"},
                      {},
                      {}};
    const bool held_out = has_held_out(diagnosis);
    table.note = held_out ? "On " + instant_text(diagnosis.heldout_from_s) + " to " +
                                instant_text(diagnosis.heldout_to_s) +
                                ", which fitted no effect: the effects behind these figures were found in "
                                "the time before. The errors here only choose, per output, between them and "
                                "plain least squares."
                          : "Over " + diagnosis.scope + ", which the extended model was fitted to.";
    for (std::size_t k = 0; k < diagnosis.output_names.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k);
        table.rows.push_back({diagnosis.output_names[k], diagnosis.output_units[k],
                              diagnosis.nominal.rms[row], percent(diagnosis.nominal.nrmse[row]),
                              diagnosis.extended.rms[row], percent(diagnosis.extended.nrmse[row]),
                              percent(diagnosis.least_squares.nrmse[row])});
    }
    table.note +=
        " Errors are those of the samples as measured, at their own rate. Plain least squares: each "
        "output by itself, with a gain of the rigid body, inertia, viscous and dry friction and an offset.";
    if (diagnosis.standstill_share.maxCoeff() > noticeable_standstill) {
        add_moving_errors(table, diagnosis);
    }
    return table;
}

std::string carried_words(const DiagnosisCase& one, const Finding& finding) {
    const auto found = std::ranges::find_if(one.extension.carried, [&](const ExtendedFinding& carried) {
        return carried.effect == finding.effect && carried.where == finding.where;
    });
    if (found == one.extension.carried.end()) {
        return "–";
    }
    static const std::map<ExtendedFinding::How, const char*> words{
        {ExtendedFinding::How::adapting, "adapting"},
        {ExtendedFinding::How::fixed, "constant"},
        {ExtendedFinding::How::approximated, "as Coulomb"},
        {ExtendedFinding::How::left_out, "left out"}};
    return words.at(found->how);
}

ReportTable findings_table(const DiagnosisCase& one) {
    const Diagnosis& diagnosis = one.work.diagnosis;
    ReportTable table{"Causes, by the ratio of the errors before and after",
                      {"cause", "main parameter (95 % interval)", "confidence", "output", "error before",
                       "after", "in the extended model"},
                      {},
                      {}};
    table.note =
        "Confidence: of all causes that are given 0.9, about nine in ten are right. Errors: rms over " +
        diagnosis.scope + ", below " + rounded_text(reduction_below_hz) +
        " Hz (all of it, for what shows above only), without and with this one effect, in N·m or N. Extended "
        "model: adapting, as coefficients that start here and go on being learned; constant, in its "
        "geometry, gravity or gains; as Coulomb friction of the same level, for the model's columns have no "
        "memory; left out, where the effect is no function of the motion of one instant that the firmware "
        "has a column for.";
    for (const Finding& finding : diagnosis.findings) {
        table.rows.push_back({cause_words(finding), main_parameter_words(finding),
                              confidence_text(finding.confidence),
                              diagnosis.output_names[static_cast<std::size_t>(finding.output)],
                              finding.rms_before, finding.rms_after, carried_words(one, finding)});
    }
    return table;
}

ReportTable nuisance_table(const Diagnosis& diagnosis) {
    ReportTable table{"Fitted, but not causes",
                      {"where", "quantity", "value", "95 % interval", "in the robot's file", "unit"},
                      {},
                      {}};
    table.note =
        "Torque constants: none were given. Masses: the recording fits better when each differs by a few "
        "percent, but no single link stands out. The extended model starts at these values.";
    for (const NuisanceEstimate& one : diagnosis.nuisance_estimates) {
        const FoundParameter& parameter = one.parameter;
        table.rows.push_back({one.where, parameter.name == "mass" ? "mass" : "torque constant",
                              parameter.value, interval_words(parameter),
                              one.given ? ReportCell(*one.given) : ReportCell("–"), parameter.unit});
    }
    return table;
}

PageSection overview_section(const DiagnosisCase& one) {
    PageSection section{"What is wrong, and what it brings to know it", {}, {}, {}};
    section.tables.push_back(error_table(one.work.diagnosis));
    if (!one.work.diagnosis.findings.empty()) {
        section.tables.push_back(findings_table(one));
    }
    if (!one.work.diagnosis.nuisance_estimates.empty()) {
        section.tables.push_back(nuisance_table(one.work.diagnosis));
    }
    return section;
}

PageSection online_section(const OnlineView& online, const Diagnosis& diagnosis) {
    PageSection section{"As an online learner sees it", {}, {}, {}};
    section.paragraphs.emplace_back(
        "Learners that see positions only, as the firmware does, run over the recording tick by tick: each "
        "predicts a sample, then learns it. P starts at the robot's own parameters, NP and SPK (100 random "
        "features) from nothing; the extended model starts where this recording put it.");
    if (!online.left_out.empty()) {
        section.paragraphs.push_back("Some learners with random features were not run: " + online.left_out +
                                     ".");
    }
    ReportTable table{"One-step error, of the measured output's deviation", {"learner"}, {}, {}};
    table.note = "First third of the recording: the transient; the rest: steady.";
    for (const std::string& name : diagnosis.output_names) {
        table.columns.push_back(name + " first third");
        table.columns.push_back(name + " rest");
    }
    for (const OnlineError& learner : online.learners) {
        std::vector<ReportCell> row{learner.learner};
        for (Eigen::Index output = 0; output < learner.steady.size(); ++output) {
            row.emplace_back(learner.transient[output]);
            row.emplace_back(learner.steady[output]);
        }
        table.rows.push_back(std::move(row));
    }
    section.tables.push_back(std::move(table));
    return section;
}

std::vector<ReportFact> facts(const DiagnosisCase& one) {
    std::vector<ReportFact> result{{"Robot", one.robot.name + ", " + one.robot.base + " to " + one.robot.tip +
                                                 ", " + std::to_string(one.robot.joints.size()) + " joints"},
                                   {"Recordings", recording_names(one.recordings)}};
    if (one.work.signals != nullptr) {
        const MeasuredMotion& measured = one.work.signals->measured;
        result.push_back({"Analysed", std::to_string(measured.time_s.size()) + " rows at " +
                                          rounded_text(measured.rate_hz) + " Hz; positions low-passed at " +
                                          rounded_text(measured.smoothing_hz.minCoeff()) + " to " +
                                          rounded_text(measured.smoothing_hz.maxCoeff()) +
                                          " Hz, where their spectrum falls to that of their noise"});
    }
    result.push_back({"Build", build_flags()});
    return result;
}

} // namespace

std::string diagnosis_page(const DiagnosisCase& one) {
    const Diagnosis& diagnosis = one.work.diagnosis;
    FigurePage page{"What the simulation of " + one.robot.name + " gets wrong", summary(one), {}, facts(one)};
    if (!diagnosis.suspicions.empty()) {
        page.sections.push_back(suspicion_section(diagnosis));
    }
    if (effects_fitted(one.work)) {
        page.sections.push_back(overview_section(one));
        page.sections.push_back(comparison_section(one.work, one.full_data));
        for (std::size_t i = 0; i < diagnosis.findings.size(); ++i) {
            page.sections.push_back(finding_section(one.work, diagnosis.findings[i], i + 1));
        }
        page.sections.push_back(rest_section(one.work));
        if (!one.online.learners.empty()) {
            page.sections.push_back(online_section(one.online, diagnosis));
        }
    }
    return render_figure_page(page);
}

} // namespace dfdyn::tools
