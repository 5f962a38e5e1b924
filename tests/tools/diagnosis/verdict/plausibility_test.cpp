// SPDX-License-Identifier: Apache-2.0
// Recordings that a diagnosis cannot use: it reports the reason and names no cause.
#include "tools/diagnosis/diagnosis.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/robot/arms.hpp"
#include "tools/diagnosis/signals/rigid_model.hpp"
#include "tools/diagnosis/verdict/plausibility.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace {

using namespace dfdyn::tools;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A recording of an exact UR5. Each test below adds one mistake.
struct CleanRecording {
    double duration_s = 30, rate_hz = 100;
    MatrixXd position, torque;

    explicit CleanRecording(double seconds = 30, double amplitude = 0.6) : duration_s(seconds) {
        const auto rows = static_cast<Index>(duration_s * rate_hz);
        RobotMotion motion{MatrixXd(rows, 6), MatrixXd(rows, 6), MatrixXd(rows, 6)};
        const Eigen::ArrayXd time = VectorXd::LinSpaced(rows, 0, static_cast<double>(rows - 1) / rate_hz);
        for (Index joint = 0; joint < 6; ++joint) {
            const double omega = 0.9 + 0.31 * static_cast<double>(joint);
            motion.position.col(joint) = amplitude * (omega * time + static_cast<double>(joint)).sin() - 0.4;
            motion.velocity.col(joint) =
                amplitude * omega * (omega * time + static_cast<double>(joint)).cos();
            motion.acceleration.col(joint) =
                -amplitude * omega * omega * (omega * time + static_cast<double>(joint)).sin();
        }
        position = motion.position;
        torque = rigid_outputs(dfdyn::tests::ur5(), OutputKind::joint_torque, motion);
    }

    Recording recording(double time_scale = 1) const {
        Recording result;
        result.source = "run.csv";
        for (int joint = 1; joint <= 6; ++joint) {
            result.position.names.push_back("q" + std::to_string(joint));
            result.output.names.push_back("tau" + std::to_string(joint));
        }
        for (Index row = 0; row < position.rows(); ++row) {
            result.time_s.push_back(time_scale * static_cast<double>(row) / rate_hz);
            result.time_ns.push_back(std::llround(1e9 * result.time_s.back()));
            result.gap_before.push_back(row == 0 ? 1 : 0);
            for (Index joint = 0; joint < 6; ++joint) {
                result.position.values.push_back(position(row, joint));
                result.output.values.push_back(torque(row, joint));
            }
        }
        return result;
    }
};

Diagnosis diagnosis_of(const Recording& recording) {
    DiagnosisOptions options;
    options.measure = false;
    return diagnose(dfdyn::tests::ur5(), recording, options).diagnosis;
}

void check_refused(const Diagnosis& diagnosis, const std::string& code, const std::string& words) {
    INFO("expected: " << code << ", " << words);
    CHECK(refused(diagnosis));
    bool said = false;
    for (const Suspicion& suspicion : diagnosis.suspicions) {
        INFO(suspicion.code << ": " << suspicion.text);
        said = said || (suspicion.code == code && suspicion.text.find(words) != std::string::npos);
        CHECK(suspicion.code.empty() == suspicion.where.empty());
    }
    CHECK(said);
    CHECK(diagnosis.findings.empty());
}

} // namespace

TEST_CASE("a recording without errors raises no suspicion and has a negligible residual") {
    const Diagnosis diagnosis = diagnosis_of(CleanRecording().recording());
    CHECK(diagnosis.suspicions.empty());
    CHECK(diagnosis.nominal.nrmse.maxCoeff() < 0.01);
}

TEST_CASE("positions in degrees or thousandths and times in ms and torques in mN·m are reported") {
    CleanRecording degrees;
    degrees.position *= 180 / std::numbers::pi;
    check_refused(diagnosis_of(degrees.recording()), "position_unit", "looks like degrees");
    CleanRecording thousandths;
    thousandths.position *= 1000;
    check_refused(diagnosis_of(thousandths.recording()), "position_unit", "looks like thousandths");
    check_refused(diagnosis_of(CleanRecording().recording(1000)), "time_unit", "looks like milliseconds");
    CleanRecording torques;
    torques.torque *= 1000;
    check_refused(diagnosis_of(torques.recording()), "output_unit", "another unit");
}

TEST_CASE("exchanged columns of positions and of outputs are reported") {
    CleanRecording positions;
    positions.position.col(1).swap(positions.position.col(2));
    check_refused(diagnosis_of(positions.recording()), "joint_order", "positions 2 and 3 look exchanged");
    CleanRecording torques;
    torques.torque.col(0).swap(torques.torque.col(3));
    check_refused(diagnosis_of(torques.recording()), "joint_order", "outputs 1 and 4 look exchanged");
}

TEST_CASE(
    "unrelated outputs and a resting arm and a single moving joint and a short recording are reported") {
    CleanRecording other; // outputs that do not belong to this motion
    for (Index joint = 0; joint < 6; ++joint) {
        const Eigen::ArrayXd time = VectorXd::LinSpaced(other.torque.rows(), 0, other.duration_s);
        other.torque.col(joint) = 20 * (4.3 * time + static_cast<double>(joint)).sin();
    }
    check_refused(diagnosis_of(other.recording()), "wrong_robot",
                  "expected the outputs of the robot's model");
    check_refused(diagnosis_of(CleanRecording(30, 0.001).recording()), "standing", "the arm is stationary");
    check_refused(diagnosis_of(CleanRecording(2).recording()), "too_little_information",
                  "s long: a diagnosis needs");
    CleanRecording one;
    for (Index joint = 1; joint < 6; ++joint) {
        one.position.col(joint).setConstant(one.position(0, joint));
    }
    const Diagnosis diagnosis = diagnosis_of(one.recording());
    REQUIRE_FALSE(diagnosis.suspicions.empty());
    CHECK(diagnosis.suspicions.front().text.find("only one joint moves") != std::string::npos);
}

TEST_CASE("a recording with more noise than the motion changes its outputs is not refused as another robot") {
    CleanRecording weak(30, 0.2);
    std::mt19937_64 engine(1);
    std::normal_distribution<double> normal;
    for (Index joint = 0; joint < 6; ++joint) {
        const VectorXd torque = weak.torque.col(joint);
        const double size = std::sqrt((torque.array() - torque.mean()).square().mean());
        for (double& value : weak.torque.col(joint)) {
            value += 1.7 * size * normal(engine);
        }
    }
    const Diagnosis diagnosis = diagnosis_of(weak.recording());
    INFO((diagnosis.suspicions.empty() ? "" : diagnosis.suspicions.front().text));
    CHECK_FALSE(refused(diagnosis));
}

TEST_CASE("a single joint that moves slowly under noise is not refused as another robot") {
    CleanRecording one;
    const Index rows = one.position.rows();
    RobotMotion motion{MatrixXd::Constant(rows, 6, -0.4), MatrixXd::Zero(rows, 6), MatrixXd::Zero(rows, 6)};
    const Eigen::ArrayXd phase = 0.2 * VectorXd::LinSpaced(rows, 0, one.duration_s).array();
    motion.position.col(0) = 0.5 * phase.sin();
    motion.velocity.col(0) = 0.1 * phase.cos();
    motion.acceleration.col(0) = -0.02 * phase.sin();
    one.position = motion.position;
    one.torque = rigid_outputs(dfdyn::tests::ur5(), OutputKind::joint_torque, motion);
    std::mt19937_64 engine(1);
    std::normal_distribution<double> noise(0, 0.3); // N·m
    for (Index joint = 0; joint < 6; ++joint) {
        for (double& value : one.torque.col(joint)) {
            value += noise(engine);
        }
    }
    const Diagnosis diagnosis = diagnosis_of(one.recording());
    INFO((diagnosis.suspicions.empty() ? "" : diagnosis.suspicions.front().text));
    CHECK_FALSE(refused(diagnosis));
}

TEST_CASE("the last row of a recording counts for a step of its duration") {
    CHECK(suspicions_of_file(CleanRecording(3).recording()).empty());
    CHECK(suspicions_of_file(CleanRecording(2.99).recording()).size() == 1);
}
