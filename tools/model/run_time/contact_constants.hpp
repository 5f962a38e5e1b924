// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include "dfdyn/monitor/joint_deviation.hpp"

#include <vector>

namespace dfdyn::tools {

inline constexpr float no_contact_limit = 1e30F; ///< nothing reaches it

/// Returns the constants of a dfdyn::ContactDetector, one per joint. Empty if `contact` is. Without a usual
/// speed or acceleration, as in models of older versions, the limits do not grow with the motion.
std::vector<ContactLimits<float>> contact_constants(const ContactModel& contact);

} // namespace dfdyn::tools
