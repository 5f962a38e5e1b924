// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/scenario/robot_errors.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"

#include <optional>
#include <string>

namespace dfdyn::tools {

namespace {

void apply(const LinkError& error, InertialParameters& body, double share) {
    const double mass = body[0] + share * error.delta_mass;
    if (body[0] == 0 && share * error.delta_mass == 0) {
        return;
    }
    if (!(mass > 0 && body[0] > 0)) {
        throw InputError("link " + std::to_string(error.joint + 1) +
                         ": expected a mass that stays positive, found " + number_text(mass) + " kg");
    }
    const CentralBody described = central_body(body);
    const Eigen::Matrix3d spread = share * error.delta_inertia.asDiagonal();
    body = body_parameters(mass, described.centre + error.delta_centre, described.inertia + spread);
    const std::optional<std::string> fault = inertia_fault(body);
    if (fault && !spread.isZero(0)) {
        throw InputError("link " + std::to_string(error.joint + 1) +
                         ": expected an inertia that a body can have, found that " + *fault);
    }
}

} // namespace

Robot real_robot(Robot described, const RobotErrors& errors) {
    for (const LinkError& error : errors.links) {
        InertialParameters& whole = described.joints.at(error.joint).inertia;
        if (described.sensor && described.sensor->link == error.joint + 1 && whole[0] > 0) {
            InertialParameters& beyond = described.sensor->inertia_beyond;
            apply(error, beyond, beyond[0] / whole[0]);
        }
        apply(error, whole, 1);
    }
    if (errors.tilt_x == 0 && errors.tilt_y == 0) {
        return described;
    }
    const Eigen::Matrix3d turn = (Eigen::AngleAxisd(errors.tilt_y, Eigen::Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(errors.tilt_x, Eigen::Vector3d::UnitX()))
                                     .toRotationMatrix();
    const Eigen::Matrix3d& base = described.base_in_root;
    described.gravity = base.transpose() * turn.transpose() * base * described.gravity;
    return described;
}

} // namespace dfdyn::tools
