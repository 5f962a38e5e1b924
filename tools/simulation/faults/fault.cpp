// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault.hpp"

namespace dfdyn::tools {

ArmFaults::ArmFaults(Eigen::Index joints)
    : friction_factor(JointVector::Ones(joints)), actuator_gain(JointVector::Ones(joints)),
      actuator_limit(JointVector::Constant(joints, std::numeric_limits<double>::infinity())),
      load(JointVector::Zero(joints)) {}

EncoderFaults::EncoderFaults(Eigen::Index joints) : jump(JointVector::Zero(joints)) {}

TorqueSensorFaults::TorqueSensorFaults(Eigen::Index joints)
    : factor(JointVector::Ones(joints)), bias(JointVector::Zero(joints)) {}

} // namespace dfdyn::tools
