// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/setup_check/simulated_runs.hpp"

#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/inertia.hpp"
#include "tools/robot/motion.hpp"
#include "tools/robot/regressor.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

namespace dfdyn::tests {

using tools::OutputKind;
using tools::Recording;
using tools::Robot;
using tools::RobotMotion;

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double uniform(std::mt19937_64& engine, double low, double high) {
    return low + (high - low) * 0x1p-53 * static_cast<double>(engine() >> 11U);
}

bool chance(std::mt19937_64& engine, double probability) { return uniform(engine, 0, 1) < probability; }

/// Three tones per joint, with speeds that sum to about `speed`.
RobotMotion multisine(Index joints, const RunKind& kind, std::mt19937_64& engine) {
    const auto rows = static_cast<Index>(kind.duration_s * kind.rate_hz);
    const Eigen::ArrayXd time = VectorXd::LinSpaced(rows, 0, static_cast<double>(rows - 1) / kind.rate_hz);
    RobotMotion motion;
    motion.position = motion.velocity = motion.acceleration = MatrixXd::Zero(rows, joints);
    for (Index joint = 0; joint < joints; ++joint) {
        motion.position.col(joint).setConstant(uniform(engine, -1.5, 1.5));
        const bool moves = kind.moving.empty() || kind.moving[static_cast<std::size_t>(joint)];
        for (int tone = 0; moves && tone < 3; ++tone) {
            const double omega = kind.speed * uniform(engine, 0.5, 2.5);
            const double amplitude = uniform(engine, 0.1, 0.5);
            const Eigen::ArrayXd phase = omega * time + uniform(engine, 0, 2 * std::numbers::pi);
            motion.position.col(joint).array() += amplitude * phase.sin();
            motion.velocity.col(joint).array() += amplitude * omega * phase.cos();
            motion.acceleration.col(joint).array() -= amplitude * omega * omega * phase.sin();
        }
    }
    return motion;
}

/// Moves by polynomials of fifth order from posture to posture, with a rest after each. A mean step, of 1
/// rad, has its largest speed at `speed`.
RobotMotion moves_and_rests(Index joints, const RunKind& kind, std::mt19937_64& engine) {
    const auto rows = static_cast<Index>(kind.duration_s * kind.rate_hz);
    const double move_s = 1.875 / kind.speed;
    const auto moves = static_cast<Index>(kind.duration_s / (move_s + kind.rest_s)) + 2;
    const Index postures = kind.postures > 0 ? kind.postures : moves;
    RobotMotion motion;
    motion.position = motion.velocity = motion.acceleration = MatrixXd::Zero(rows, joints);
    for (Index joint = 0; joint < joints; ++joint) {
        VectorXd posture(postures);
        for (double& one : posture) {
            one = uniform(engine, -1.5, 1.5);
        }
        if (!kind.moving.empty() && !kind.moving[static_cast<std::size_t>(joint)]) {
            posture.setConstant(posture[0]);
        }
        for (Index row = 0; row < rows; ++row) {
            const double time_s = static_cast<double>(row) / kind.rate_hz;
            const auto move = static_cast<Index>(time_s / (move_s + kind.rest_s));
            const double from = posture[move % postures];
            const double step = posture[(move + 1) % postures] - from;
            const double since_s = time_s - static_cast<double>(move) * (move_s + kind.rest_s);
            const double x = std::min(1.0, since_s / move_s);
            motion.position(row, joint) = from + step * x * x * x * (10 + x * (6 * x - 15));
            motion.velocity(row, joint) = step / move_s * 30 * x * x * (1 - x) * (1 - x);
            motion.acceleration(row, joint) = step / (move_s * move_s) * 60 * x * (1 - x) * (1 - 2 * x);
        }
    }
    return motion;
}

Robot loaded(Robot robot, double payload_kg, std::mt19937_64& engine) {
    const Eigen::Vector3d centre =
        robot.tip_placement *
        Eigen::Vector3d(uniform(engine, -0.2, 0.2), uniform(engine, -0.2, 0.2), uniform(engine, -0.2, 0.2));
    robot.joints.back().inertia +=
        tools::body_parameters(payload_kg, centre, 0.002 * payload_kg * Eigen::Matrix3d::Identity());
    return robot;
}

void add_friction(MatrixXd& torque, const RobotMotion& motion, const RunKind& kind, std::mt19937_64& engine) {
    for (Index joint = 0; joint < torque.cols(); ++joint) {
        const double level = kind.friction * std::max(0.1, torque.col(joint).cwiseAbs().maxCoeff()) *
                             uniform(engine, 0.5, 1.5);
        double held = 0;
        double direction = 0; // of the last move
        for (Index row = 0; row < torque.rows(); ++row) {
            const double velocity = motion.velocity(row, joint);
            const bool rests = kind.rest_s > 0 && velocity == 0;
            if (rests && (row == 0 || motion.velocity(row - 1, joint) != 0)) {
                const double least = direction != 0 && chance(engine, 0.5) ? 0 : -1.3;
                held = (direction < 0 ? -level : level) * uniform(engine, least, 1.3);
            }
            direction = rests ? direction : velocity;
            torque(row, joint) += rests ? held : level * (std::tanh(velocity / 0.01) + 0.3 * velocity);
        }
    }
}

void add_noise(MatrixXd& values, const VectorXd& deviation, std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    for (Index column = 0; column < values.cols(); ++column) {
        for (Index row = 0; row < values.rows(); ++row) {
            values(row, column) += deviation[column] * normal(engine);
        }
    }
}

VectorXd deviations(const MatrixXd& values) {
    const MatrixXd centred = values.rowwise() - values.colwise().mean();
    return centred.colwise().norm().transpose() / std::sqrt(static_cast<double>(values.rows()));
}

/// Standard deviation of the outputs' noise. A moving joint without any torque, as of a body without inertia
/// about the axis, has at least the noise of its sensor: no measured output is constant.
VectorXd output_noise(const MatrixXd& outputs, const RobotMotion& motion, const RunKind& kind) {
    constexpr double sensor = 1e-3;
    const VectorXd deviation = deviations(outputs);
    VectorXd noise = kind.noise * deviation;
    for (Index joint = 0; joint < motion.position.cols() && kind.outputs != OutputKind::wrench; ++joint) {
        const auto position = motion.position.col(joint);
        if (deviation[joint] < 1e-9 && position.maxCoeff() > position.minCoeff()) {
            noise[joint] = sensor;
        }
    }
    return noise;
}

/// 6 kg, or the arm's own mass if it is lighter.
double heaviest_payload(const Robot& robot) {
    double mass = 0;
    for (const tools::RobotJoint& joint : robot.joints) {
        mass += joint.inertia[0];
    }
    return std::min(6.0, mass);
}

} // namespace

std::string RunKind::describe() const {
    std::ostringstream text;
    text << (outputs == OutputKind::wrench         ? "wrench"
             : outputs == OutputKind::joint_torque ? "torques"
                                                   : "currents")
         << ", speed " << speed << ", " << rate_hz << " Hz, " << duration_s << " s, payload " << payload_kg
         << " kg, friction " << friction << ", noise " << noise << ", rests of " << rest_s << " s, postures "
         << postures << ", moving";
    for (const bool moves : moving) {
        text << ' ' << moves;
    }
    return text.str();
}

Recording simulated_run(const Robot& robot, const RunKind& kind, std::mt19937_64& engine) {
    const auto joints = static_cast<Index>(robot.joints.size());
    const RobotMotion motion =
        kind.rest_s > 0 ? moves_and_rests(joints, kind, engine) : multisine(joints, kind, engine);
    const Robot truth = loaded(robot, kind.payload_kg, engine);
    const VectorXd stacked = tools::stacked_regressor(truth, kind.outputs, motion) *
                             tools::nominal_parameters(truth, kind.outputs);
    MatrixXd outputs = tools::unstacked(stacked, stacked.size() / motion.rows());
    if (kind.outputs != OutputKind::wrench) {
        add_friction(outputs, motion, kind, engine);
    }
    if (kind.outputs == OutputKind::motor_current) {
        for (Index joint = 0; joint < joints; ++joint) {
            outputs.col(joint) /= 0.5 * std::pow(40, uniform(engine, 0, 1));
        }
    }
    add_noise(outputs, output_noise(outputs, motion, kind), engine);
    MatrixXd position = motion.position;
    add_noise(position, VectorXd::Constant(joints, kind.position_noise), engine);
    Recording recording;
    recording.source = "simulated.csv";
    recording.position.names = tools::joint_names("q", robot.joints.size());
    recording.output.names = tools::output_names(kind.outputs, robot.joints.size());
    for (Index row = 0; row < motion.rows(); ++row) {
        recording.time_s.push_back(static_cast<double>(row) / kind.rate_hz);
        recording.time_ns.push_back(std::llround(1e9 * recording.time_s.back()));
        recording.gap_before.push_back(row == 0 ? 1 : 0);
        for (Index joint = 0; joint < joints; ++joint) {
            recording.position.values.push_back(position(row, joint));
        }
        for (Index output = 0; output < outputs.cols(); ++output) {
            recording.output.values.push_back(outputs(row, output));
        }
    }
    return recording;
}

RunKind random_kind(const Robot& robot, OutputKind outputs, std::mt19937_64& engine) {
    RunKind kind;
    kind.outputs = outputs;
    kind.speed = 0.05 * std::pow(60, uniform(engine, 0, 1));
    kind.rate_hz = 40 * std::pow(25, uniform(engine, 0, 1));
    kind.duration_s = uniform(engine, 8, 40);
    kind.payload_kg = chance(engine, 0.5) ? uniform(engine, 0, heaviest_payload(robot)) : 0;
    kind.friction = chance(engine, 0.5) ? uniform(engine, 0, 1) : 0;
    kind.noise = chance(engine, 0.5) ? uniform(engine, 0, 0.3) : 0;
    kind.position_noise = chance(engine, 0.5) ? 0 : 1e-4 * uniform(engine, 0, 1);
    kind.rest_s = chance(engine, 0.3) ? uniform(engine, 0.5, 3) : 0;
    kind.postures = chance(engine, 0.5) ? 2 + static_cast<int>(engine() % 3) : 0;
    if (chance(engine, 0.5)) {
        for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
            kind.moving.push_back(chance(engine, 0.5));
        }
        kind.moving[engine() % kind.moving.size()] = true;
    }
    return kind;
}

} // namespace dfdyn::tests
