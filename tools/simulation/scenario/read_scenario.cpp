// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/scenario/scenario.hpp"

#include "tools/base/system/read_file.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/simulation/scenario/scenario_reader.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

namespace dfdyn::tools {

namespace {

constexpr std::string_view schema = "dfdyn.scenario/1";

nlohmann::json load(const std::filesystem::path& path) {
    return parse_json(read_file(path, "cannot be read as a scenario"), shown(path));
}

/// Refuses a robot with more joints than a JointVector holds, before the first one is filled.
void check_joint_count(const Robot& robot) {
    if (robot.joints.empty() || robot.joints.size() > largest_simulated_chain) {
        throw InputError("robot " + robot.name + ": expected a chain of 1 to " +
                         std::to_string(largest_simulated_chain) + " joints, found " +
                         std::to_string(robot.joints.size()));
    }
}

std::vector<std::string> read_columns(const JsonReader& reader) {
    static constexpr std::string_view known[] = {"q", "qd", "qdd", "tau", "i", "wrench"};
    std::vector<std::string> columns = reader.texts("columns", static_cast<int>(std::size(known)));
    for (const std::string& column : columns) {
        if (std::ranges::find(known, column) == std::end(known) || std::ranges::count(columns, column) > 1) {
            throw reader.error("columns", "some of q, qd, qdd, tau, i, wrench, once each", in_quotes(column));
        }
    }
    return columns;
}

RecordingModel read_recording_model(const ScenarioReader& reader) {
    reader.allow_only(
        {"rate_hz", "first_at_s", "samples", "instant_jitter_s", "stamp_jitter_s", "columns", "noise"});
    RecordingModel model;
    model.rate_hz = reader.json().number_within("rate_hz", 1e-3, 1e5);
    model.first_at_s = reader.within("first_at_s", 0, 1e6, model.first_at_s);
    model.samples = static_cast<std::size_t>(reader.json().whole_number("samples", 1, 100'000'000));
    // neighbouring samples must not overlap at four standard deviations
    const double most = 0.05 / model.rate_hz;
    model.instant_jitter_s = reader.within("instant_jitter_s", 0, most, 0);
    model.stamp_jitter_s = reader.within("stamp_jitter_s", 0, most, 0);
    model.columns = read_columns(reader.json());
    return model;
}

ControllerModel read_controller(const ScenarioReader& reader) {
    reader.allow_only({"kind", "rate_hz", "position_gain", "velocity_gain", "mass_error"});
    ControllerModel model;
    static const std::map<std::string, ControllerKind> kinds{
        {"computed_torque", ControllerKind::computed_torque},
        {"gravity_compensation", ControllerKind::gravity_compensation},
        {"feed_forward", ControllerKind::feed_forward}};
    const std::string kind = reader.json().text("kind");
    const auto found = kinds.find(kind);
    if (found == kinds.end()) {
        throw reader.json().error("kind", "computed_torque, feed_forward or gravity_compensation",
                                  in_quotes(kind));
    }
    model.kind = found->second;
    model.rate_hz = reader.within("rate_hz", 1, 1e5, model.rate_hz);
    model.position_gain = reader.per_joint("position_gain");
    model.velocity_gain = reader.per_joint("velocity_gain");
    model.mass_error = reader.within("mass_error", 0, 1, 0);
    return model;
}

EncoderModel read_encoders(const ScenarioReader& reader) {
    reader.allow_only({"rate_hz", "bits_per_turn", "noise_rad", "eccentricity_rad", "eccentricity_phase_rad",
                       "offset_rad"});
    EncoderModel model;
    model.rate_hz = reader.within("rate_hz", 1, 1e5, model.rate_hz);
    model.bits_per_turn = reader.json().whole_or("bits_per_turn", 0, 0, 40);
    model.noise = reader.within("noise_rad", 0, 1, 0);
    model.eccentricity = reader.per_joint("eccentricity_rad", 0);
    model.eccentricity_phase = reader.per_joint("eccentricity_phase_rad", 0);
    model.offset = reader.optional_per_joint("offset_rad");
    return model;
}

DerivativeModel read_derivatives(const ScenarioReader& reader, double encoder_rate_hz) {
    reader.allow_only({"rate_hz", "velocity_window", "acceleration_window", "noise_bound_rad"});
    DerivativeModel model;
    model.rate_hz = reader.within("rate_hz", 1, 1e5, encoder_rate_hz);
    model.velocity_window = reader.json().whole_number("velocity_window", 2, 1000);
    model.acceleration_window = reader.json().whole_number("acceleration_window", 3, 1000);
    model.noise_bound = reader.within("noise_bound_rad", 0, 1, 0);
    return model;
}

/// `robot`: for a message only.
WrenchSensorModel read_force_torque(const ScenarioReader& reader, const Robot& robot) {
    reader.allow_only({"rate_hz", "bits", "range", "calibration", "noise", "bandwidth_hz", "order", "bias",
                       "drift_per_s", "delay_s", "rotation_rad"});
    if (!robot.sensor) {
        throw reader.json().error("range", "a robot with a force/torque sensor",
                                  "none on the chain " + robot.base + " to " + robot.tip);
    }
    WrenchSensorModel model;
    model.rate_hz = reader.within("rate_hz", 1, 1e5, model.rate_hz);
    model.bits = reader.json().whole_or("bits", model.bits, 2, 40);
    model.range = Eigen::Map<const Wrench>(reader.json().positive_numbers("range", 6).data());
    if (reader.json().has("rotation_rad")) {
        model.rotation = reader.three("rotation_rad");
    }
    if (reader.json().has("calibration")) {
        model.calibration = Eigen::Map<const WrenchMatrix>(reader.json().numbers("calibration", 36).data());
    }
    model.noise = reader.six("noise");
    model.bandwidth_hz = reader.within("bandwidth_hz", 0, 1e5, 0);
    model.order = reader.json().whole_or("order", model.order, 1, 2);
    model.bias = reader.six("bias");
    model.drift_per_s = reader.six("drift_per_s");
    model.delay_s = reader.within("delay_s", 0, 10, 0);
    return model;
}

/// Checks that the rate `whole_hz`, named `of`, is a multiple of `rate_hz`.
void check_rate(const JsonReader& reader, const std::string& name, double rate_hz, const std::string& of,
                double whole_hz) {
    const double ratio = whole_hz / rate_hz;
    if (!(ratio >= 1 && std::abs(ratio - std::round(ratio)) < 1e-9 * ratio)) {
        throw reader.error(name, of + " to be a multiple of it", number_text(rate_hz));
    }
}

void check_rates(const JsonReader& reader, const Scenario& scenario) {
    const double rate = scenario.integration_rate_hz;
    const std::string name = "integration_rate_hz";
    check_rate(reader, "controller.rate_hz", scenario.controller.rate_hz, name, rate);
    check_rate(reader, "encoders.rate_hz", scenario.encoders.rate_hz, name, rate);
    check_rate(reader, "derivatives.rate_hz", scenario.derivatives.rate_hz, "encoders.rate_hz",
               scenario.encoders.rate_hz);
    if (scenario.force_torque) {
        check_rate(reader, "force_torque.rate_hz", scenario.force_torque->rate_hz, name, rate);
        if (!(scenario.force_torque->bandwidth_hz < rate / 2)) {
            throw reader.error("force_torque.bandwidth_hz", "less than half of integration_rate_hz",
                               number_text(scenario.force_torque->bandwidth_hz));
        }
    }
    if (!(scenario.recording.rate_hz <= rate)) {
        throw reader.error("recording.rate_hz", "at most integration_rate_hz",
                           number_text(scenario.recording.rate_hz));
    }
}

void check_columns(const JsonReader& reader, const Scenario& scenario) {
    const std::vector<std::string>& columns = scenario.recording.columns;
    if (!scenario.force_torque && std::ranges::count(columns, "wrench") > 0) {
        throw reader.error("recording.columns", "force_torque to be given for wrench", "none");
    }
    if (!scenario.torque_sensor.torque_constant && std::ranges::count(columns, "i") > 0) {
        throw reader.error("recording.columns", "actuators.torque_constant_nm_per_a to be given for i",
                           "none");
    }
}

} // namespace

ScenarioChain read_scenario_chain(const std::filesystem::path& path) {
    const nlohmann::json json = load(path);
    const JsonReader reader(json, shown(path));
    if (const std::string found = reader.text("schema"); found != schema) {
        throw reader.error("schema", std::string(schema), in_quotes(found));
    }
    const ScenarioReader chain(reader.object("chain"), 0);
    chain.allow_only({"tip", "tip_point_m", "base", "ft_joint", "wrench_direction", "gravity_m_per_s2"});
    ScenarioChain result;
    result.tip = chain.json().text("tip");
    if (chain.json().has("tip_point_m")) {
        result.tip_point = chain.three("tip_point_m");
    }
    result.base = chain.text_or_empty("base");
    result.ft_joint = chain.text_or_empty("ft_joint");
    result.wrench_direction = chain.text_or_empty("wrench_direction");
    if (!result.wrench_direction.empty() && result.wrench_direction != "child_to_parent" &&
        result.wrench_direction != "parent_to_child") {
        throw chain.json().error("wrench_direction", "child_to_parent or parent_to_child",
                                 in_quotes(result.wrench_direction));
    }
    if (chain.json().has("gravity_m_per_s2")) {
        result.gravity = chain.json().numbers("gravity_m_per_s2", 3);
    }
    return result;
}

JointVector start_position(const Scenario& scenario, const JointVector& first) {
    return scenario.start_offset.size() > 0 ? JointVector(first + scenario.start_offset) : first;
}

Scenario read_scenario(const std::filesystem::path& path, const Robot& robot) {
    check_joint_count(robot);
    const nlohmann::json json = load(path);
    const ScenarioReader reader(JsonReader(json, shown(path)), static_cast<int>(robot.joints.size()));
    reader.allow_only({"schema", "chain", "seed", "integration_rate_hz", "recording", "task", "controller",
                       "actuators", "arm", "contacts", "payloads", "faults", "encoders", "derivatives",
                       "force_torque"});
    Scenario scenario;
    scenario.seed = reader.json().has("seed") ? reader.json().seed("seed") : scenario.seed;
    scenario.integration_rate_hz =
        reader.within("integration_rate_hz", 100, 1e6, scenario.integration_rate_hz);
    scenario.recording = read_recording_model(reader.object("recording"));
    scenario.task = read_task(reader.object("task"));
    scenario.controller = read_controller(reader.object("controller"));
    scenario.actuators = read_actuators(reader.object("actuators"));
    scenario.torque_sensor = read_torque_sensor(reader.object("actuators"));
    scenario.robot_errors = read_robot_errors(reader);
    scenario.loads = read_joint_loads(reader);
    scenario.start_offset = read_start_offset(reader);
    if (reader.object("recording").json().has("noise")) {
        scenario.output_noise = read_output_noise(reader.object("recording").object("noise"));
    }
    if (reader.json().has("payloads")) {
        scenario.payloads = read_payloads(reader.json());
    }
    if (reader.json().has("faults")) {
        scenario.faults = read_faults(reader, 1 / scenario.controller.rate_hz);
    }
    scenario.encoders = read_encoders(reader.object("encoders"));
    scenario.derivatives = read_derivatives(reader.object("derivatives"), scenario.encoders.rate_hz);
    if (reader.json().has("force_torque")) {
        scenario.force_torque = read_force_torque(reader.object("force_torque"), robot);
    }
    check_rates(reader.json(), scenario);
    check_columns(reader.json(), scenario);
    return scenario;
}

} // namespace dfdyn::tools
