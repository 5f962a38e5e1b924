// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/payload_schedule.hpp"

#include <utility>

namespace dfdyn::tools {

PayloadSchedule::PayloadSchedule(std::vector<Payload> payloads, const Robot& robot)
    : payloads_(std::move(payloads)), tip_(robot.tip_placement) {}

void PayloadSchedule::attach_due(double time_s, SimulatedArm& arm) {
    while (attached_ < payloads_.size() && payloads_[attached_].attached_s <= time_s) {
        const Payload& payload = payloads_[attached_++];
        arm.attach(body_parameters(payload.mass, tip_ * payload.centre, Eigen::Matrix3d::Zero()));
    }
}

} // namespace dfdyn::tools
