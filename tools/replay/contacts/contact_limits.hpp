// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/model/model.hpp"

#include <span>

namespace dfdyn::tools {

/// Measures deviations of joints without contact, for a dfdyn::ContactDetector of `model`. Its outputs must
/// be joint torques or currents, and nobody may touch the arm in `recordings`, those of the training.
///
/// Each of four blocks of time is predicted by a frozen estimator that has learned the others from the prior,
/// and all rows by the frozen model, because the errors of both differ. A joint's limit for a JointMotion is
/// the larger of 2.64 times the 99.5 % quantile of its deviations (at least the 90 % quantile of all motions)
/// and 1.375 times the largest of them. A standing joint's limit is at least a third of that of a changing
/// one, because its friction bears any torque up to the break-away torque. Then all limits grow in proportion
/// until no row has an excess above 1 / 1.2. The factors were chosen on the UR5 recordings No5 to No9. Cost:
/// five ticks per row.
ContactModel measure_contact_limits(const TrainedModel& model, std::span<const Recording> recordings);

} // namespace dfdyn::tools
