// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/model/model.hpp"

#include <span>

namespace dfdyn::tools {

/// Measures deviations of joints without contact, for a dfdyn::ContactDetector of `model`. Its outputs must
/// be joint torques or currents. `recordings`: those of the training, without any contact.
///
/// The limits of each joint are those of `joint_envelopes`, from frozen predictions of held-out blocks and of
/// the whole recordings (`calibration_rows`). The usual range of speeds and accelerations ends at their
/// 99.5 % quantile.
///
/// Then all limits are scaled to the excess that is exceeded `contact_rate_per_hour` times. It follows from
/// an exponential tail of the largest excess of each second, or of a shorter time between gaps, and from the
/// duration of all of them. With fewer than ten peaks the upper 90 % confidence limit of their mean is used.
/// The factor 1.08 accounts for motions that the training did not have. Shares and factors were chosen on the
/// UR5 recordings No5 to No9 and one simulated UR5; the rule for leaving out blocks also on a TX40.
ContactModel measure_contact_limits(const TrainedModel& model, std::span<const Recording> recordings);

} // namespace dfdyn::tools
