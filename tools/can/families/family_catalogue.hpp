// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/families/family.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// All families of boards and of sensors, in the order of the documentation.
const std::vector<JointFamily>& joint_families();
const std::vector<SensorFamily>& sensor_families();

/// Returns the family named in `family`. For an unknown name, throws InputError with all known names.
const JointFamily& joint_family(const JsonReader& joints);
const SensorFamily& sensor_family(const JsonReader& output);

/// Returns the text of docs/reference/devices.md from the families' descriptors.
std::string device_page();

} // namespace dfdyn::tools
