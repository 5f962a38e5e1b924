// SPDX-License-Identifier: Apache-2.0
#include "tools/model/run_time/contact_constants.hpp"

namespace dfdyn::tools {

std::vector<ContactLimits<float>> contact_constants(const ContactModel& contact) {
    std::vector<ContactLimits<float>> limits(contact.limit.size() / joint_motion_count);
    for (std::size_t i = 0; i < contact.limit.size(); ++i) {
        limits[i / joint_motion_count].limit[i % joint_motion_count] = static_cast<float>(contact.limit[i]);
    }
    constexpr auto moving = static_cast<std::size_t>(JointMotion::moving);
    for (std::size_t k = 0; k < limits.size(); ++k) {
        limits[k].usual = static_cast<float>(contact.usual[joint_motion_count * k + moving]);
        limits[k].relative = contact.relative.empty() ? 0 : static_cast<float>(contact.relative[k]);
        limits[k].speed = contact.speed.empty() ? no_contact_limit : static_cast<float>(contact.speed[k]);
        limits[k].acceleration =
            contact.acceleration.empty() ? no_contact_limit : static_cast<float>(contact.acceleration[k]);
        limits[k].standard_deviation =
            contact.standard_deviation.empty() ? 0 : static_cast<float>(contact.standard_deviation[k]);
        limits[k].hysteresis = contact.hysteresis.empty() ? 0 : static_cast<float>(contact.hysteresis[k]);
    }
    return limits;
}

} // namespace dfdyn::tools
