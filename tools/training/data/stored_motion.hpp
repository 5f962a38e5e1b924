// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"
#include "tools/training/data/motion.hpp"
#include "tools/training/data/row_selection.hpp"
#include "tools/training/data/training_data.hpp"

#include <vector>

namespace dfdyn::tools {

/// Returns (q, qd, qdd) of the samples `rows` as computed by a model's physics; `motion` has three rows per
/// joint.
MotionSamples stored_motion(const InputModel& motion, const TrainingData& data, const RowList& rows);

/// Returns ten times the largest position, velocity and acceleration of each joint in `data`, as computed by
/// the physics. The factor is the same as for position and output limits, because differentiated encoder
/// counts have outliers.
std::vector<double> motion_limits(const InputModel& motion, const TrainingData& data);

} // namespace dfdyn::tools
