// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/json_reader.hpp"
#include "tools/simulation/scenario/scenario.hpp"

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

namespace dfdyn::tools {

/// A section of a scenario: JsonReader's fields, and fields with a default or with one value per joint. The
/// joints are those of the robot. Every method throws InputError as JsonReader does.
class ScenarioReader {
  public:
    ScenarioReader(JsonReader json, int joint_count) : json_(std::move(json)), joint_count_(joint_count) {}

    const JsonReader& json() const noexcept { return json_; }
    int joint_count() const noexcept { return joint_count_; }
    ScenarioReader object(const std::string& name) const { return {json_.object(name), joint_count_}; }

    /// Rejects all fields that are not in `names`.
    void allow_only(std::initializer_list<std::string_view> names) const;

    /// Returns a number from `low` to `high`, or `fallback` if the field is missing.
    double within(const std::string& name, double low, double high, double fallback) const;

    std::string text_or_empty(const std::string& name) const;

    /// Returns one number per joint; a single number applies to all joints.
    JointVector per_joint(const std::string& name) const;
    JointVector per_joint(const std::string& name, double fallback) const;
    JointVector positive_per_joint(const std::string& name) const;
    /// Returns zeros if the field is missing.
    JointVector not_negative_per_joint(const std::string& name) const;
    std::optional<JointVector> optional_per_joint(const std::string& name) const;

    /// Returns three numbers; the field is required.
    Eigen::Vector3d three(const std::string& name) const;

    /// Returns six numbers; zeros if the field is missing.
    Wrench six(const std::string& name) const;

  private:
    JsonReader json_;
    int joint_count_;
};

/// Reads the section `task`.
TaskModel read_task(const ScenarioReader& reader);

/// The section `actuators`: actuator model and torque sensor.
ActuatorModel read_actuators(const ScenarioReader& reader);
TorqueSensorModel read_torque_sensor(const ScenarioReader& reader);

/// Sections of the whole scenario: deviations of the arm from its description, and external loads.
RobotErrors read_robot_errors(const ScenarioReader& reader);
JointVector read_start_offset(const ScenarioReader& reader);
JointLoads read_joint_loads(const ScenarioReader& reader);
std::vector<Payload> read_payloads(const JsonReader& reader);

/// Reads the entries of `faults`, each of a kind of the catalogue (see FaultKind). `loop_period_s`: period of
/// the loop's ticks.
std::vector<Fault> read_faults(const ScenarioReader& reader, double loop_period_s);

/// Reads the section `recording.noise`.
OutputNoiseModel read_output_noise(const ScenarioReader& reader);

} // namespace dfdyn::tools
