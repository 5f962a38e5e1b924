// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/scenario/scenario_reader.hpp"

#include "tools/base/text/number.hpp"

#include <span>

namespace dfdyn::tools {

void ScenarioReader::allow_only(std::initializer_list<std::string_view> names) const {
    json_.allow_only(std::span(names.begin(), names.size()));
}

double ScenarioReader::within(const std::string& name, double low, double high, double fallback) const {
    return json_.number_or(name, fallback, low, high);
}

std::string ScenarioReader::text_or_empty(const std::string& name) const {
    return json_.has(name) ? json_.text(name) : "";
}

JointVector ScenarioReader::per_joint(const std::string& name) const {
    if (!json_.is_array(name)) {
        return JointVector::Constant(joint_count_, json_.number(name));
    }
    const std::vector<double> values = json_.numbers(name, joint_count_);
    return Eigen::Map<const Eigen::VectorXd>(values.data(), joint_count_);
}

JointVector ScenarioReader::per_joint(const std::string& name, double fallback) const {
    return json_.has(name) ? per_joint(name) : JointVector::Constant(joint_count_, fallback);
}

JointVector ScenarioReader::positive_per_joint(const std::string& name) const {
    JointVector result = per_joint(name);
    if (!(result.minCoeff() > 0)) {
        throw json_.error(name, "positive numbers", number_text(result.minCoeff()));
    }
    return result;
}

JointVector ScenarioReader::not_negative_per_joint(const std::string& name) const {
    JointVector result = per_joint(name, 0);
    if (!(result.minCoeff() >= 0)) {
        throw json_.error(name, "numbers that are not negative", number_text(result.minCoeff()));
    }
    return result;
}

std::optional<JointVector> ScenarioReader::optional_per_joint(const std::string& name) const {
    return json_.has(name) ? std::optional(per_joint(name)) : std::nullopt;
}

Eigen::Vector3d ScenarioReader::three(const std::string& name) const {
    const std::vector<double> values = json_.numbers(name, 3);
    return Eigen::Map<const Eigen::Vector3d>(values.data());
}

Wrench ScenarioReader::six(const std::string& name) const {
    if (!json_.has(name)) {
        return Wrench::Zero();
    }
    const std::vector<double> values = json_.numbers(name, 6);
    return Eigen::Map<const Wrench>(values.data());
}

} // namespace dfdyn::tools
