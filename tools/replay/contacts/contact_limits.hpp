// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/model/model.hpp"

#include <span>

namespace dfdyn::tools {

/// Measures deviations of joints without contact, for a dfdyn::ContactDetector of `model`. Its outputs must
/// be joint torques or currents. `recordings`: those of the training, without any contact.
///
/// A frozen estimator predicts each of eight blocks of time after learning the other seven from the prior.
/// The frozen model predicts all rows. Both passes are used, because their errors differ.
///
/// A joint's limits for the three JointMotions are the 99.9 % quantiles of its deviations, or the 90 %
/// quantile over all motions if that is larger. A part of each limit is proportional to the change of the
/// prediction, with the factor that makes the limits smallest. Passes with more than twice the trained
/// model's median are left out: in a short recording some blocks have motions that the others do not
/// determine. The limit at standstill is at least half the limit near a change of the motion, because
/// friction bears any torque up to the break-away torque. The usual range of speeds and accelerations ends
/// at their 99.5 % quantile.
///
/// Then all limits are scaled to the excess that is exceeded `contact_rate_per_hour` times. It follows from
/// an exponential tail of the largest excess of each second, or of a shorter time between gaps, and from the
/// duration of all of them. With fewer than ten peaks the upper 90 % confidence limit of their mean is used.
/// The factor 1.08 accounts for motions that the training did not have. Shares and factors were chosen on the
/// UR5 recordings No5 to No9 and one simulated UR5; the rule for leaving out blocks also on a TX40. Cost:
/// nine ticks per row.
ContactModel measure_contact_limits(const TrainedModel& model, std::span<const Recording> recordings);

} // namespace dfdyn::tools
