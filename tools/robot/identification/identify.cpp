// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/identification/identify.hpp"

#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/regressor.hpp"

#include <nlohmann/json.hpp>

#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

using nlohmann::ordered_json;

constexpr Eigen::Index states_of_structure = 500; ///< many more equations than parameters
constexpr std::uint64_t seed_of_structure = 1;

ordered_json numbers(const Eigen::VectorXd& values) {
    return std::vector<double>(values.data(), values.data() + values.size());
}

ordered_json base_to_json(const Identification& identification) {
    ordered_json list = ordered_json::array();
    const BaseFit& fit = identification.fit;
    for (std::size_t i = 0; i < identification.base_names.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        ordered_json entry{{"name", identification.base_names[i]},
                           {"unit", identification.base_units[i]},
                           {"value", fit.value[row]},
                           {"nominal", fit.nominal[row]},
                           {"determined", bool(fit.determined[i])}};
        entry["deviation"] = std::isfinite(fit.deviation[row]) ? ordered_json(fit.deviation[row]) : nullptr;
        list.push_back(entry);
    }
    return list;
}

/// Writes mass, centre of mass, and inertia about the link frame's origin of each body.
ordered_json bodies_to_json(const Robot& robot, const Eigen::VectorXd& parameters) {
    ordered_json list = ordered_json::array();
    const std::size_t count = static_cast<std::size_t>(parameters.size()) / 10;
    for (std::size_t body = 0; body < count; ++body) {
        const std::size_t joint = robot.joints.size() - count + body;
        const InertialParameters own = parameters.segment<10>(static_cast<Eigen::Index>(10 * body));
        list.push_back({{"link", robot.joints[joint].link},
                        {"mass", own[0]},
                        {"centre_of_mass", numbers(own.segment<3>(1) / own[0])},
                        {"inertia_about_origin", numbers(own.tail<6>())}});
    }
    return list;
}

} // namespace

Identification identify(const Robot& robot, OutputKind outputs, const RecordedMotion& recorded,
                        std::vector<std::string> output_names, bool consistent) {
    const FitData data{stacked_regressor(robot, outputs, recorded.motion), recorded.outputs,
                       nominal_parameters(robot, outputs)};
    Identification result;
    result.outputs = outputs;
    result.output_names = std::move(output_names);
    result.samples = recorded.motion.rows();
    result.base = find_base_parameters(
        stacked_regressor(robot, outputs, random_motion(robot, states_of_structure, seed_of_structure)));
    result.base_names = base_parameter_names(result.base, parameter_names(robot, outputs));
    const std::vector<std::string> units = parameter_units(robot, outputs);
    for (const Eigen::Index column : result.base.independent) {
        result.base_units.push_back(units[static_cast<std::size_t>(column)]);
    }
    result.fit = fit_base_parameters(data, result.base);
    result.rms_nominal = rms_error(data, data.nominal);
    result.rms_fitted = rms_error(data, result.fit.parameters);
    if (consistent) {
        result.consistent = fit_consistent_parameters(data, result.fit.noise);
        result.rms_consistent = rms_error(data, *result.consistent);
    }
    return result;
}

ordered_json identification_json(const Robot& robot, const Identification& identification) {
    ordered_json json{{"schema", "dfdyn.parameters/1"},
                      {"robot", robot.name},
                      {"base", robot.base},
                      {"tip", robot.tip},
                      {"outputs", identification.output_names},
                      {"samples", identification.samples},
                      {"condition", identification.fit.condition},
                      {"base_parameters", base_to_json(identification)},
                      {"rms_nominal", numbers(identification.rms_nominal)},
                      {"rms_fitted", numbers(identification.rms_fitted)}};
    if (identification.consistent) {
        json["rms_consistent"] = numbers(identification.rms_consistent);
        json["bodies"] = bodies_to_json(robot, *identification.consistent);
    }
    return json;
}

} // namespace dfdyn::tools
