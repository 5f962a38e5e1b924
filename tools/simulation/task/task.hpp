// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"
#include "tools/robot/robot.hpp"

#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

namespace dfdyn::tools {

/// Desired motion of the controller.
struct Reference {
    JointVector position;     ///< rad
    JointVector velocity;     ///< rad/s
    JointVector acceleration; ///< rad/s²
};

/// Sum of sines with equal amplitude and evenly spaced frequencies per joint, with random phases.
struct MultisineTask {
    JointVector centre;    ///< rad
    JointVector amplitude; ///< rad: the sum of the sines' amplitudes, an upper bound
    double lowest_hz = 0.1, highest_hz = 1;
    int tones = 5;
    double start_s = 2; ///< time in which the motion grows from rest at the centre to its full size
};

/// A sine.
struct Tone {
    double hz = 1, amplitude = 0, phase = 0; ///< Hz, rad, rad
};

/// A sum of individual sines per joint.
struct TonesTask {
    JointVector centre;                   ///< rad
    std::vector<std::vector<Tone>> tones; ///< per joint
    double start_s = 2; ///< time in which the motion grows from rest at the centre to its full size
};

/// Moves from posture to posture on fifth-order polynomials, cyclically.
struct PointToPointTask {
    std::vector<JointVector> postures; ///< rad
    double move_s = 1, dwell_s = 0.5;
};

/// A circle of the tip around `centre` in the plane of two axes of the base's frame. The remaining degrees of
/// freedom follow a rest posture. As with a real Cartesian controller, the turns differ slightly: speed,
/// centre and rest posture vary slowly (SlowVariation; the sizes are standard deviations).
struct CircleTask {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero(); ///< m, in the base's frame
    double radius = 0.1;                              ///< m
    int first_axis = 0, second_axis = 1; ///< 0 x, 1 y, 2 z; direction of rotation from first to second
    double period_s = 1;
    double start_s = 2;           ///< time in which the speed grows from rest to its full size
    JointVector rest_posture;     ///< rad
    double rest_pull = 1;         ///< 1/s
    double speed_variation = 0;   ///< relative
    double centre_variation = 0;  ///< m, each coordinate
    double posture_variation = 0; ///< rad, each joint
    double variation_time_s = 10;
};

using TaskModel = std::variant<MultisineTask, TonesTask, PointToPointTask, CircleTask>;

/// Generates the reference step by step.
class Task {
  public:
    virtual ~Task() = default;
    /// Returns the next reference. The first one is at rest, at time 0; the following ones are one period
    /// apart.
    virtual Reference next() = 0;
};

/// Returns the task. Throws InputError with source and field if the tip cannot reach a circle or a joint
/// would exceed its limits on it. The message contains the excess and the place.
std::unique_ptr<Task> make_task(const TaskModel& model, const Robot& robot, double period_s,
                                std::uint64_t seed);

/// Fifth-order polynomial from 0 to 1 at rest at both ends, and its derivatives.
struct SmoothStep {
    double value, rate, acceleration;
};

/// Returns the step at `time_s` after its start, for a duration of `duration_s`. At rest before and after it.
SmoothStep smooth_step(double time_s, double duration_s);

} // namespace dfdyn::tools
