// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/motion.hpp"

#include "tools/base/recording/columns_matrix.hpp"
#include "tools/base/recording/sample_grid.hpp"
#include "tools/base/text/error.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

namespace dfdyn::tools {

namespace {

/// Returns a uniform number in [low, high). std::uniform_real_distribution differs between standard
/// libraries.
double uniform(std::mt19937_64& engine, double low, double high) {
    return low + (high - low) * 0x1p-53 * static_cast<double>(engine() >> 11U);
}

void append(Eigen::MatrixXd& to, const Eigen::MatrixXd& from, const std::vector<Eigen::Index>& rows) {
    Eigen::MatrixXd joined(to.rows() + static_cast<Eigen::Index>(rows.size()), from.cols());
    joined << to, from(rows, Eigen::all);
    to = std::move(joined);
}

void start_with_columns(RecordedMotion& result, const RecordedMotion& like) {
    result.motion.position.resize(0, like.motion.position.cols());
    result.motion.velocity = result.motion.acceleration = result.motion.position;
    result.outputs.resize(0, like.outputs.cols());
}

} // namespace

RobotMotion random_motion(const Robot& robot, Eigen::Index rows, std::uint64_t seed) {
    std::mt19937_64 engine(seed);
    const auto joints = static_cast<Eigen::Index>(robot.joints.size());
    RobotMotion motion{Eigen::MatrixXd(rows, joints), Eigen::MatrixXd(rows, joints),
                       Eigen::MatrixXd(rows, joints)};
    for (Eigen::Index row = 0; row < rows; ++row) {
        for (Eigen::Index i = 0; i < joints; ++i) {
            const RobotJoint& joint = robot.joints[static_cast<std::size_t>(i)];
            const double reach = joint.prismatic ? 0.5 : std::numbers::pi;
            const double speed =
                std::min(joint.prismatic ? 1.0 : 3.0, joint.velocity.value_or(joint.prismatic ? 1.0 : 3.0));
            const double rate = joint.prismatic ? 5.0 : 10.0;
            motion.position(row, i) =
                uniform(engine, joint.lower.value_or(-reach), joint.upper.value_or(reach));
            motion.velocity(row, i) = uniform(engine, -speed, speed);
            motion.acceleration(row, i) = uniform(engine, -rate, rate);
        }
    }
    return motion;
}

ZeroPhaseWindow rigid_body_window(std::span<const Recording> recordings) {
    constexpr long least_samples = 3;
    const long samples = std::lround(rigid_body_window_s / sample_period_s(recordings));
    return {static_cast<int>(std::max(samples, least_samples)), 3};
}

SampledMotion sampled_motion(const Recording& recording, const ZeroPhaseWindow& window) {
    SampledMotion states;
    RobotMotion& motion = states.all.motion;
    motion.position = columns_matrix(recording.position);
    states.all.outputs = columns_matrix(recording.output);
    if (recording.velocity.present() && recording.acceleration.present()) {
        motion.velocity = columns_matrix(recording.velocity);
        motion.acceleration = columns_matrix(recording.acceleration);
        states.valid.assign(recording.row_count(), 1);
    } else if (recording.velocity.present()) {
        SampledDerivatives derivatives = zero_phase_derivatives(recording, recording.velocity, window);
        motion.velocity = columns_matrix(recording.velocity);
        motion.acceleration = std::move(derivatives.first);
        states.valid = std::move(derivatives.valid);
    } else {
        SampledDerivatives derivatives = zero_phase_derivatives(recording, recording.position, window);
        motion.velocity = std::move(derivatives.first);
        motion.acceleration = std::move(derivatives.second);
        states.valid = std::move(derivatives.valid);
    }
    return states;
}

RecordedMotion recorded_motion(std::span<const Recording> recordings, const ZeroPhaseWindow& window) {
    RecordedMotion result;
    for (const Recording& recording : recordings) {
        const SampledMotion states = sampled_motion(recording, window);
        if (&recording == recordings.data()) {
            start_with_columns(result, states.all);
        }
        std::vector<Eigen::Index> kept;
        for (std::size_t row = 0; row < states.valid.size(); ++row) {
            if (states.valid[row] != 0) {
                kept.push_back(static_cast<Eigen::Index>(row));
            }
        }
        append(result.motion.position, states.all.motion.position, kept);
        append(result.motion.velocity, states.all.motion.velocity, kept);
        append(result.motion.acceleration, states.all.motion.acceleration, kept);
        append(result.outputs, states.all.outputs, kept);
    }
    if (result.motion.rows() == 0) {
        throw InputError(recordings.front().source + ": expected " +
                         std::to_string(2 * window.half_width + 1) +
                         " rows without a gap to take derivatives of, found fewer");
    }
    return result;
}

} // namespace dfdyn::tools
