// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/json_reader.hpp"
#include "tools/simulation/scenario/scenario.hpp"

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

namespace dfdyn::tools {

/// A section of a scenario: JsonReader's fields, and those with a default or with one value per joint. The
/// joints are those of the robot. Every method throws InputError as JsonReader does.
class ScenarioReader {
  public:
    ScenarioReader(JsonReader json, int joint_count) : json_(std::move(json)), joint_count_(joint_count) {}

    const JsonReader& json() const noexcept { return json_; }
    int joint_count() const noexcept { return joint_count_; }
    ScenarioReader object(const std::string& name) const { return {json_.object(name), joint_count_}; }

    /// Refuses every field but these.
    void allow_only(std::initializer_list<std::string_view> names) const;

    /// A number from `low` to `high`, or `fallback` where the field is missing.
    double within(const std::string& name, double low, double high, double fallback) const;

    std::string text_or_empty(const std::string& name) const;

    /// One number per joint, or one number for all of them.
    JointVector per_joint(const std::string& name) const;
    JointVector per_joint(const std::string& name, double fallback) const;
    JointVector positive_per_joint(const std::string& name) const;
    std::optional<JointVector> optional_per_joint(const std::string& name) const;

    /// Six numbers; zeros where the field is missing.
    Wrench six(const std::string& name) const;

  private:
    JsonReader json_;
    int joint_count_;
};

/// The section `task`.
TaskModel read_task(const ScenarioReader& reader);

/// The section `actuators`: what moves the joints, and what shows their torques.
ActuatorModel read_actuators(const ScenarioReader& reader);
TorqueSensorModel read_torque_sensor(const ScenarioReader& reader);

/// Of the whole scenario: how the arm differs from its description, and what else acts on it.
RobotErrors read_robot_errors(const ScenarioReader& reader);
JointLoads read_joint_loads(const ScenarioReader& reader);
std::vector<Payload> read_payloads(const JsonReader& reader);

/// The entries of `faults`, each of a kind of the catalogue (see FaultKind). `loop_period_s`: of the loop's
/// ticks.
std::vector<Fault> read_faults(const ScenarioReader& reader, double loop_period_s);

/// The section `recording.noise`.
OutputNoiseModel read_output_noise(const ScenarioReader& reader);

} // namespace dfdyn::tools
