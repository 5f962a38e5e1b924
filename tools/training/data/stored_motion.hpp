// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/data/motion.hpp"
#include "tools/training/data/row_selection.hpp"
#include "tools/training/data/training_data.hpp"

#include <vector>

namespace dfdyn::tools {

/// (q, qd, qdd) of the samples `rows` as a model's physics sees them; `motion` has three rows per joint.
MotionSamples stored_motion(const InputModel& motion, const TrainingData& data, const RowList& rows);

/// The largest position, velocity and acceleration of each joint that the physics sees in `data`, times ten:
/// as wide as the limits of positions and outputs, for differentiated counts have tails.
std::vector<double> motion_limits(const InputModel& motion, const TrainingData& data);

} // namespace dfdyn::tools
