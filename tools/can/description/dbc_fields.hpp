// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/json_reader.hpp"
#include "tools/can/description/dbc.hpp"
#include "tools/can/description/dbc_device.hpp"

#include <span>

namespace dfdyn::tools {

/// Reads the joint that an entry of `boards` maps to signals of `dbc`. `before`: the joints read so far.
/// Errors like those of JsonReader.
DbcJoint read_dbc_joint(const JsonReader& board, const Dbc& dbc, std::span<const DbcJoint> before);

/// Reads the sensor whose six signals are named in `output.wrench`.
DbcSensor read_dbc_sensor(const JsonReader& output, const Dbc& dbc);

} // namespace dfdyn::tools
