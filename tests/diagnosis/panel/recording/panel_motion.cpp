// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/recording/panel_setup.hpp"

#include <algorithm>
#include <numbers>

namespace dfdyn::tests {

using namespace tools;

namespace {

constexpr double limit_margin = 0.12; // rad, kept free before a joint's limit

/// Centre and half range of a joint's motion.
struct Range {
    double centre, half;
};

Range random_range(const PanelRobot& kind, const RobotJoint& joint, Draw& draw) {
    const double low =
        joint.lower ? std::max(*joint.lower + limit_margin, -std::numbers::pi) : -std::numbers::pi;
    const double high =
        joint.upper ? std::min(*joint.upper - limit_margin, std::numbers::pi) : std::numbers::pi;
    const double widest = std::min(kind.largest_range, (high - low) / 2);
    const double half = widest * draw.uniform(0.55, 1);
    return {draw.uniform(low + half, high - half), half};
}

/// Random tones with larger amplitudes at low frequencies, within the range and the speed.
std::vector<Tone> random_tones(double half, double speed, Draw& draw) {
    std::vector<Tone> tones(static_cast<std::size_t>(draw.whole(3, 7)));
    double sum = 0;
    double fastest = 0;
    for (Tone& tone : tones) {
        tone.hz = draw.log_uniform(0.05, 1);
        tone.amplitude = draw.uniform(0.3, 1) / std::sqrt(tone.hz);
        tone.phase = draw.uniform(-std::numbers::pi, std::numbers::pi);
        sum += tone.amplitude;
        fastest += 2 * std::numbers::pi * tone.hz * tone.amplitude;
    }
    const double scale = std::min(half / sum, speed / fastest);
    for (Tone& tone : tones) {
        tone.amplitude *= scale;
    }
    return tones;
}

/// Returns whether the joint's limits allow a slow tone of more than one turn.
bool turns_round(const RobotJoint& joint) {
    const double whole_turn = 2 * std::numbers::pi + limit_margin;
    return (!joint.lower || *joint.lower <= -whole_turn + 2 * limit_margin) &&
           (!joint.upper || *joint.upper >= whole_turn - 2 * limit_margin);
}

TonesTask random_multisine(const PanelRobot& kind, const Robot& robot, bool whole_turns, Draw& draw) {
    TonesTask task;
    task.centre.resize(static_cast<Eigen::Index>(robot.joints.size()));
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        const RobotJoint& joint = robot.joints[i];
        const Range range = random_range(kind, joint, draw);
        task.centre[static_cast<Eigen::Index>(i)] = range.centre;
        task.tones.push_back(random_tones(range.half, kind.speed, draw));
        if (whole_turns && turns_round(joint) && draw.chance(0.5)) {
            task.centre[static_cast<Eigen::Index>(i)] = 0;
            const Tone turn{draw.uniform(0.03, 0.06), draw.uniform(3.3, 4.2),
                            draw.uniform(-std::numbers::pi, std::numbers::pi)};
            task.tones.back() = random_tones(1.2, kind.speed / 2, draw);
            task.tones.back().push_back(turn);
        }
    }
    task.start_s = draw.uniform(2, 4);
    return task;
}

PointToPointTask random_postures(const PanelRobot& kind, const Robot& robot, double duration_s, Draw& draw) {
    PointToPointTask task;
    task.move_s = draw.uniform(1.2, 2.5);
    task.dwell_s = draw.uniform(0.2, 0.8);
    const double farthest = kind.speed * task.move_s / 1.875; // peak speed of the fifth-order polynomial
    std::vector<Range> ranges;
    for (const RobotJoint& joint : robot.joints) {
        ranges.push_back(random_range(kind, joint, draw));
    }
    const auto count = static_cast<std::size_t>(duration_s / (task.move_s + task.dwell_s)) + 2;
    for (std::size_t posture = 0; posture < count; ++posture) {
        JointVector& position = task.postures.emplace_back(static_cast<Eigen::Index>(ranges.size()));
        for (std::size_t i = 0; i < ranges.size(); ++i) {
            const double half = std::min(ranges[i].half, farthest / 2);
            position[static_cast<Eigen::Index>(i)] =
                draw.uniform(ranges[i].centre - half, ranges[i].centre + half);
        }
    }
    return task;
}

/// A few postures, again and again, or one joint after another out of one posture.
PointToPointTask repeated_postures(const PanelRobot& kind, const Robot& robot, bool one_by_one, Draw& draw) {
    PointToPointTask task = random_postures(kind, robot, 10, draw);
    task.dwell_s = draw.log_uniform(0.2, 3);
    if (!one_by_one) {
        task.postures.resize(static_cast<std::size_t>(draw.whole(3, 6)), task.postures.front());
        return task;
    }
    const JointVector centre = task.postures[0];
    const JointVector other = task.postures[1];
    task.postures.clear();
    for (Eigen::Index joint = 0; joint < centre.size(); ++joint) {
        JointVector moved = centre;
        moved[joint] = other[joint];
        task.postures.push_back(centre);
        task.postures.push_back(moved);
    }
    return task;
}

} // namespace

TaskModel random_task(const PanelRobot& kind, const Robot& robot, double duration_s, Draw& draw) {
    if (kind.conditions.everyday_motion && draw.chance(0.4)) {
        return repeated_postures(kind, robot, draw.chance(0.4), draw);
    }
    if (draw.chance(0.3)) {
        return random_postures(kind, robot, duration_s, draw);
    }
    return random_multisine(kind, robot, draw.chance(0.3), draw);
}

} // namespace dfdyn::tests
