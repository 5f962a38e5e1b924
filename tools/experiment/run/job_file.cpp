// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/run/job_file.hpp"

#include "tools/base/system/atomic_file.hpp"
#include "tools/base/text/json_text.hpp"
#include "tools/build_flags.hpp"
#include "tools/experiment/plan/file_checksum.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/inputs/input_description.hpp"

#include <fstream>

namespace dfdyn::tools {

namespace {

using nlohmann::ordered_json;

constexpr const char* job_schema = "dfdyn.evaluated-unit/2";

ordered_json case_json(const Case& one) {
    return {{"name", one.name},
            {"model", one.model},
            {"input", input_description(one.input).name},
            {"hyper", one.hyper},
            {"physics_input", one.physics_input},
            {"effects", one.effects},
            {"prior", one.prior},
            {"lags", one.lags},
            {"rows_per_joint", one.rows_per_joint},
            {"features", one.feature_count},
            {"orthogonal", one.orthogonal},
            {"relevance", one.relevance},
            {"centred", one.centred},
            {"forgetting", one.forgetting_factor},
            {"likelihood_rows", one.likelihood_rows},
            {"starts", one.starts}};
}

/// Returns the JSON of the case, or of the cases that it combines.
ordered_json cases_json(const Plan& plan, const Case& one) {
    if (one.members.empty()) {
        return case_json(one);
    }
    ordered_json json = ordered_json::array();
    for (const std::string& name : one.members) {
        json.push_back(case_json(case_named(plan, name)));
    }
    return json;
}

ordered_json protocol_json(const Plan& plan) {
    ordered_json json{{"start_rows", plan.start_rows},
                      {"training_rows", plan.training_rows.value_or(0)},
                      {"most_online_rows", plan.most_online_rows.value_or(0)},
                      {"horizon", plan.horizon},
                      {"error_scale", to_string(plan.error_scale)},
                      {"robot",
                       {plan.robot.base, plan.robot.tip, plan.robot.ft_joint, plan.robot.gravity,
                        plan.robot.sign_velocity, plan.robot.torque_constants}}};
    for (const TestLog& test : plan.tests) {
        json["tests"].push_back({test.first, test.rows, test.count});
    }
    for (const OutputGroup& group : plan.groups) {
        json["groups"].push_back({group.name, group.outputs});
    }
    return json;
}

/// Build flags of the running program, and its checksum if its file is readable.
const std::string& program() {
    static const std::string known = [] {
        const std::filesystem::path itself = "/proc/self/exe";
        return std::filesystem::exists(itself) ? build_flags() + "; " + file_checksum(itself) : build_flags();
    }();
    return known;
}

} // namespace

ordered_json job_inputs(const Plan& plan, const PlanData& data, const Case& one, std::uint64_t seed) {
    ordered_json inputs{{"case", cases_json(plan, one)},
                        {"seed", seed},
                        {"protocol", protocol_json(plan)},
                        {"files", ordered_json::array()},
                        {"program", program()}};
    for (const auto& [name, checksum] : data.checksums) {
        inputs["files"].push_back({name, checksum});
    }
    return inputs;
}

JobResult write_job(const std::filesystem::path& path, const ordered_json& inputs, const JobResult& result) {
    make_folder(path.parent_path());
    const ordered_json json{{"schema", job_schema}, {"inputs", inputs}, {"result", job_to_json(result)}};
    write_file(path, json_text(json, -1) + "\n");
    return unit_from_json(json.at("result"));
}

std::optional<JobResult> read_job(const std::filesystem::path& path, const ordered_json& inputs) {
    std::ifstream file(path, std::ios::binary);
    const ordered_json json = ordered_json::parse(file, nullptr, false);
    try {
        if (json.at("schema") != job_schema || json.at("inputs") != inputs) {
            return std::nullopt;
        }
        return unit_from_json(json.at("result"));
    } catch (const ordered_json::exception&) {
        return std::nullopt;
    }
}

} // namespace dfdyn::tools
