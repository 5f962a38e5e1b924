// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/robot/dynamics/joint_vector.hpp"
#include "tools/simulation/faults/fault.hpp"

#include <optional>
#include <vector>

namespace dfdyn::tools {

/// What stands between the actuators' torques and their readings, and what a current is.
struct TorqueSensorModel {
    JointVector noise;                          ///< N·m, standard deviation
    std::optional<JointVector> torque_constant; ///< N·m/A, at the joint, as the scenario believes it
    std::optional<JointVector> gain;            ///< true over assumed torque: a reading is the torque over it
    std::optional<JointVector> offset;          ///< N·m, added to the reading
    std::optional<JointVector> delay_s;         ///< how far a reading lags

    /// A; only where there are torque constants.
    JointVector current(const JointVector& torque) const { return torque.cwiseQuotient(*torque_constant); }
};

/// Delay (fractions of a step by linear interpolation), gain, offset, noise, faults.
class TorqueSensor {
  public:
    /// `period_s`: of the simulation's steps.
    TorqueSensor(const TorqueSensorModel& model, double period_s, std::uint64_t seed);

    /// One step of the simulation.
    void observe(const JointVector& torque);

    void set_faults(const TorqueSensorFaults& faults) { faults_ = faults; }

    /// Of the torque at hand, `torque`, or of an earlier one: another noise in every call.
    JointVector read(const JointVector& torque);

  private:
    JointVector delayed() const;

    TorqueSensorModel model_;
    JointVector delay_steps_;
    std::vector<JointVector> past_; ///< ring; empty without delay
    std::size_t newest_ = 0;
    NormalSource noise_;
    std::optional<TorqueSensorFaults> faults_;
};

} // namespace dfdyn::tools
