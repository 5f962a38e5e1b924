// SPDX-License-Identifier: Apache-2.0
#include "tools/can/motors/motor_board.hpp"

#include "tools/base/text/number.hpp"

namespace dfdyn::tools {

std::vector<BusFinding> velocity_findings(const VelocityCheck& check, int joint, const ScaleAdvice& advice) {
    if (!check.contradicts()) {
        return {};
    }
    const std::string name = "joint " + std::to_string(joint + 1);
    const std::string evidence = "its positions change " + rounded_text(check.ratio()) +
                                 " times as fast, over " + rounded_text(check.distance_rad()) + " rad";
    constexpr double standing = 0.02;
    if (std::abs(check.ratio()) < standing) {
        return {{"encoder_frozen", name + " does not move while its motor reports a velocity", evidence,
                 "move the joint by hand: the bytes of its position do not change",
                 "Check the encoder and its cable. Restart the motor."}};
    }
    if (check.ratio() < 0) {
        return {{"velocity_sign", name + " moves against its motor's velocity", evidence,
                 "turn the joint by hand: position and velocity have the same sign",
                 "Correct the sign of the motor's transmission or of its encoder."}};
    }
    return {{"velocity_scale", name + " moves at a speed that differs from its motor's velocity", evidence,
             advice.confirm, advice.fix}};
}

} // namespace dfdyn::tools
