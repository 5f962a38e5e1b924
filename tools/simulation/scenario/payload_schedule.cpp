// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/scenario/payload_schedule.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

PayloadSchedule::PayloadSchedule(std::vector<Payload> payloads, const Robot& robot)
    : payloads_(std::move(payloads)), tip_(robot.tip_placement) {}

void PayloadSchedule::attach(const Payload& payload, SimulatedArm& arm) const {
    arm.attach(body_parameters(payload.mass, tip_ * payload.centre, Eigen::Matrix3d::Zero()));
}

void PayloadSchedule::update(double time_s, SimulatedArm& arm) {
    const bool removal = std::ranges::any_of(payloads_, [&](const Payload& payload) {
        return carried(payload, last_s_) && !carried(payload, time_s);
    });
    if (removal) {
        arm.release();
    }
    for (const Payload& payload : payloads_) {
        if (carried(payload, time_s) && (removal || !carried(payload, last_s_))) {
            attach(payload, arm);
        }
    }
    last_s_ = time_s;
}

} // namespace dfdyn::tools
