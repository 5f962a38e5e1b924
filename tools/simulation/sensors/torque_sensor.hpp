// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/robot/dynamics/joint_vector.hpp"
#include "tools/simulation/faults/fault.hpp"
#include "tools/simulation/sensors/delay_line.hpp"

#include <optional>

namespace dfdyn::tools {

/// Errors of the torque readings relative to the actuators' torques, and the conversion to currents.
struct TorqueSensorModel {
    JointVector noise;                          ///< N·m, standard deviation
    std::optional<JointVector> torque_constant; ///< N·m/A, at the joint, as assumed by the scenario
    std::optional<JointVector> gain;    ///< true over assumed torque: a reading is the torque divided by it
    std::optional<JointVector> offset;  ///< N·m, added to the reading
    std::optional<JointVector> delay_s; ///< delay of a reading

    /// Returns the current (A) for a torque; requires torque constants.
    JointVector current(const JointVector& torque) const { return torque.cwiseQuotient(*torque_constant); }
};

/// Applies delay (fractions of a step by linear interpolation), gain, offset, noise and faults.
class TorqueSensor {
  public:
    /// `period_s`: step of the simulation.
    TorqueSensor(const TorqueSensorModel& model, double period_s, std::uint64_t seed);

    /// Adds the torque of one simulation step.
    void observe(const JointVector& torque);

    void set_faults(const TorqueSensorFaults& faults) { faults_ = faults; }

    /// Returns a reading for the current torque or, with a delay, for an earlier one. Each call draws new
    /// noise.
    JointVector read(const JointVector& torque);

  private:
    TorqueSensorModel model_;
    std::optional<DelayLine<JointVector>> delay_;
    NormalSource noise_;
    std::optional<TorqueSensorFaults> faults_;
};

} // namespace dfdyn::tools
