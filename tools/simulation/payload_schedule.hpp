// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/simulation/simulated_arm.hpp"

#include <vector>

namespace dfdyn::tools {

/// A body that is fixed to the tip at some time, as a gripper takes a part: not in the robot's URDF, and no
/// controller knows of it.
struct Payload {
    double attached_s = 0;
    double mass = 0;                                  ///< kg, in one point
    Eigen::Vector3d centre = Eigen::Vector3d::Zero(); ///< m, in the tip frame
};

/// Attaches payloads to an arm when their time comes.
class PayloadSchedule {
  public:
    /// `payloads`: in order of time.
    PayloadSchedule(std::vector<Payload> payloads, const Robot& robot);

    /// All that are due by `time_s`.
    void attach_due(double time_s, SimulatedArm& arm);

  private:
    std::vector<Payload> payloads_;
    Eigen::Isometry3d tip_;
    std::size_t attached_ = 0;
};

} // namespace dfdyn::tools
