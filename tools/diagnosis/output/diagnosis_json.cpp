// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/diagnosis_json.hpp"

#include "tools/base/numerics/to_vector.hpp"
#include "tools/diagnosis/output/finding_words.hpp"

#include <nlohmann/json.hpp>

#include <vector>

namespace dfdyn::tools {

namespace {

using nlohmann::ordered_json;

ordered_json to_json(const ErrorMeasure& error) {
    return {{"rms", to_vector(error.rms)},
            {"nrmse", to_vector(error.nrmse)},
            {"nrmse_moving", to_vector(error.moving_nrmse)}};
}

ordered_json causes(const std::vector<OtherCause>& list, bool reasons) {
    ordered_json result = ordered_json::array();
    for (const OtherCause& cause : list) {
        ordered_json entry{{"effect", cause.effect}, {"where", cause.where}};
        if (reasons) {
            entry["why_not"] = cause.why_not;
        }
        result.push_back(std::move(entry));
    }
    return result;
}

/// Writes a sensor axis by its name instead of its number.
ordered_json value_of(const FoundParameter& parameter) {
    const std::optional<std::string> axis = axis_of(parameter);
    return axis ? ordered_json(*axis) : ordered_json(parameter.value);
}

ordered_json to_json(const FoundParameter& parameter) {
    ordered_json entry{{"name", parameter.name}, {"value", value_of(parameter)}};
    if (!entry["value"].is_string()) {
        entry["unit"] = parameter.unit;
        if (parameter.low < parameter.high) {
            entry["ci95"] = {parameter.low, parameter.high};
        } else {
            entry["ci95"] = nullptr; // not fitted
        }
    }
    return entry;
}

ordered_json to_json(const NuisanceEstimate& nuisance) {
    ordered_json entry = to_json(nuisance.parameter);
    entry["where"] = nuisance.where;
    if (nuisance.given) {
        entry["given"] = *nuisance.given;
    }
    return entry;
}

/// Adds the values of a finding in several recordings.
void add_recordings(ordered_json& json, const Finding& finding) {
    if (!finding.by_recording.empty()) {
        json["spread"] = finding.spread;
        for (const ValueOfRecording& one : finding.by_recording) {
            json["by_recording"].push_back(
                {{"recording", one.recording}, {"value", one.value}, {"ci95", {one.low, one.high}}});
        }
    }
    if (!finding.only_in.empty()) {
        json["only_in"] = finding.only_in;
    }
}

ordered_json to_json(const Finding& finding, const std::string& output) {
    ordered_json parameters = ordered_json::array();
    for (const FoundParameter& parameter : finding.parameters) {
        parameters.push_back(to_json(parameter));
    }
    ordered_json json{
        {"effect", finding.effect},
        {"where", finding.where},
        {"parameters", std::move(parameters)},
        {"confidence", finding.confidence},
        {"gain", {{"output", output}, {"rms_before", finding.rms_before}, {"rms_after", finding.rms_after}}},
        {"evidence", finding.evidence},
        {"indistinguishable", causes(finding.indistinguishable, false)},
        {"alternatives", causes(finding.alternatives, true)},
        {"confirm", finding.confirm}};
    add_recordings(json, finding);
    return json;
}

/// Returns the errors of plain least squares, and its coefficients for each output.
ordered_json textbook_json(const Diagnosis& diagnosis) {
    ordered_json json = to_json(diagnosis.least_squares);
    ordered_json coefficients = ordered_json::array();
    for (Eigen::Index output = 0; output < diagnosis.textbook.cols(); ++output) {
        const auto of = diagnosis.textbook.col(output);
        coefficients.push_back(
            {{"gain", of[0]}, {"inertia", of[1]}, {"viscous", of[2]}, {"coulomb", of[3]}, {"offset", of[4]}});
    }
    if (!coefficients.empty()) {
        json["coefficients"] = std::move(coefficients);
    }
    return json;
}

ordered_json texts(const std::vector<Suspicion>& suspicions) {
    ordered_json json = ordered_json::array();
    for (const Suspicion& suspicion : suspicions) {
        json.push_back(suspicion.words());
    }
    return json;
}

ordered_json refusals(const std::vector<Suspicion>& suspicions) {
    ordered_json json = ordered_json::array();
    for (const Suspicion& suspicion : suspicions) {
        if (!suspicion.code.empty()) {
            json.push_back(
                {{"code", suspicion.code}, {"where", suspicion.where}, {"text", suspicion.words()}});
        }
    }
    return json;
}

} // namespace

ordered_json diagnosis_json(const Diagnosis& diagnosis) {
    ordered_json json{
        {"schema", "dfdyn.diagnosis/1"},
        {"outputs", diagnosis.output_names},
        {"suspicions", texts(diagnosis.suspicions)},
        {"refused", refused(diagnosis)},
        {"refusals", refusals(diagnosis.suspicions)},
        {"nominal", to_json(diagnosis.nominal)},
        {"extended", to_json(diagnosis.extended)},
        {"least_squares", textbook_json(diagnosis)},
        {"extended_by_least_squares", diagnosis.by_least_squares},
        {"heldout",
         {{"from", diagnosis.heldout_from_s},
          {"to", diagnosis.heldout_to_s},
          {"note", has_held_out(diagnosis) ? "errors on data that were not used for fitting"
                                           : "nothing was held out: errors on the data used for fitting"}}}};
    if (!diagnosis.recordings.empty()) {
        json["recordings"] = diagnosis.recordings;
    }
    ordered_json findings = ordered_json::array();
    for (const Finding& finding : diagnosis.findings) {
        findings.push_back(
            to_json(finding, diagnosis.output_names[static_cast<std::size_t>(finding.output)]));
    }
    json["findings"] = std::move(findings);
    ordered_json nuisance_estimates = ordered_json::array();
    for (const NuisanceEstimate& one : diagnosis.nuisance_estimates) {
        nuisance_estimates.push_back(to_json(one));
    }
    json["granted"] = std::move(nuisance_estimates);
    ordered_json unexplained = ordered_json::array();
    for (const Unexplained& entry : diagnosis.unexplained) {
        unexplained.push_back({{"output", diagnosis.output_names[static_cast<std::size_t>(entry.output)]},
                               {"nrmse", entry.nrmse},
                               {"depends_on", entry.depends_on},
                               {"note", entry.note}});
    }
    json["unexplained"] = std::move(unexplained);
    return json;
}

} // namespace dfdyn::tools
