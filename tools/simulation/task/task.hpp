// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"
#include "tools/robot/robot.hpp"

#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

namespace dfdyn::tools {

/// What the controller is to follow.
struct Reference {
    JointVector position;     ///< rad
    JointVector velocity;     ///< rad/s
    JointVector acceleration; ///< rad/s²
};

/// Sum of sines of equal size and evenly spaced frequencies per joint, with random phases.
struct MultisineTask {
    JointVector centre;    ///< rad
    JointVector amplitude; ///< rad: the sum of the sines' amplitudes, never exceeded
    double lowest_hz = 0.1, highest_hz = 1;
    int tones = 5;
    double start_s = 2; ///< the motion grows from rest at the centre to its full size
};

/// A sine.
struct Tone {
    double hz = 1, amplitude = 0, phase = 0; ///< Hz, rad, rad
};

/// Per joint a sum of sines of its own.
struct TonesTask {
    JointVector centre;                   ///< rad
    std::vector<std::vector<Tone>> tones; ///< per joint
    double start_s = 2;                   ///< the motion grows from rest at the centre to its full size
};

/// From posture to posture on fifth-order polynomials, in turn, for ever.
struct PointToPointTask {
    std::vector<JointVector> postures; ///< rad
    double move_s = 1, dwell_s = 0.5;
};

/// A circle of the tip around `centre` in the plane of two axes of the base's frame. What the tip leaves free
/// follows a rest posture. As under a real Cartesian controller no turn is quite like the last: speed,
/// centre and rest posture wander (SlowVariation; the sizes are standard deviations).
struct CircleTask {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero(); ///< m, in the base's frame
    double radius = 0.1;                              ///< m
    int first_axis = 0, second_axis = 1;              ///< 0 x, 1 y, 2 z; the turn goes from first to second
    double period_s = 1;
    double start_s = 2;           ///< the speed grows from rest to its full size
    JointVector rest_posture;     ///< rad
    double rest_pull = 1;         ///< 1/s
    double speed_variation = 0;   ///< of 1
    double centre_variation = 0;  ///< m, each coordinate
    double posture_variation = 0; ///< rad, each joint
    double variation_time_s = 10;
};

using TaskModel = std::variant<MultisineTask, TonesTask, PointToPointTask, CircleTask>;

/// The reference, step by step.
class Task {
  public:
    virtual ~Task() = default;
    /// The first is at rest, at time 0; each further one is a period later.
    virtual Reference next() = 0;
};

/// Throws InputError, with source and field, when the tip cannot reach a circle or a joint would leave its
/// limits on it: by how much, and where.
std::unique_ptr<Task> make_task(const TaskModel& model, const Robot& robot, double period_s,
                                std::uint64_t seed);

/// Fifth-order polynomial from 0 to 1 at rest at both ends, and its derivatives.
struct SmoothStep {
    double value, rate, acceleration;
};

/// At `time_s` after the start of a rise that takes `duration_s`; before and after it: at rest.
SmoothStep smooth_step(double time_s, double duration_s);

} // namespace dfdyn::tools
