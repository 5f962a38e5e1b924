// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/model/model.hpp"

#include <span>

namespace dfdyn::tools {

/// Measures deviations of joints without contact, for a dfdyn::ContactDetector of `model`. Its outputs must
/// be joint torques or currents, and nobody may touch the arm in `recordings`, those of the training.
///
/// Each of eight blocks of time is predicted by a frozen estimator that has learned the others from the
/// prior, and all rows by the frozen model, because the errors of both differ.
///
/// A joint's limits for the three JointMotions are the 99.9 % quantiles of its deviations, or the 90 %
/// quantile of all motions if that is larger. Left out are passes with more than
/// twice the trained model's median: in a short recording some blocks have motions that the others do not
/// determine. A part of them is in proportion to the change of the
/// prediction, by the factor that makes the limits smallest. A standing joint's limit is at least half of
/// that of a changing one, because its friction bears any torque up to the break-away torque. Speeds and
/// accelerations are usual up to their 99.5 % quantile.
///
/// Then all limits are scaled to the excess that is exceeded `contact_rate_per_hour` times, from an
/// exponential tail of its largest values in each second (of fewer than ten peaks, with the upper 60 %
/// confidence limit of the mean), times 1.08 for motions that the training did not have. The shares and
/// factors were chosen on the UR5 recordings No5 to No9 and one simulated UR5; which blocks are left out,
/// with a TX40 in sight. Cost: nine ticks per row.
ContactModel measure_contact_limits(const TrainedModel& model, std::span<const Recording> recordings);

} // namespace dfdyn::tools
