// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/plausibility.hpp"

#include "tools/common/number.hpp"
#include "tools/common/quantile.hpp"
#include "tools/recording/stretches.hpp"

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dfdyn::tools {

namespace {

constexpr double degrees = 180 / std::numbers::pi;
constexpr double least_travel = 0.05; ///< rad (m): a joint that moves less stands
constexpr double least_duration_s = 10;

double correlation(const Eigen::VectorXd& one, const Eigen::VectorXd& other) {
    const Eigen::VectorXd a = one.array() - one.mean();
    const Eigen::VectorXd b = other.array() - other.mean();
    const double scale = a.norm() * b.norm();
    return scale > 0 ? a.dot(b) / scale : 0;
}

double largest(const Columns& columns, std::size_t index) {
    double result = 0;
    for (std::size_t i = index; i < columns.values.size(); i += columns.names.size()) {
        result = std::max(result, std::abs(columns.values[i]));
    }
    return result;
}

/// How far a joint may be from zero, with some play.
double reach(const RobotJoint& joint) {
    const double limit =
        joint.lower ? std::max(std::abs(*joint.lower), std::abs(*joint.upper)) : 2 * std::numbers::pi;
    return 1.2 * limit;
}

std::string joint_list(const std::vector<std::size_t>& joints) {
    std::string text;
    for (const std::size_t joint : joints) {
        text += (text.empty() ? "" : ", ") + std::to_string(joint + 1);
    }
    return text;
}

void suspect_position_unit(const Robot& robot, const Recording& recording, Suspicions& result) {
    std::vector<std::size_t> beyond;
    double factor = 0;
    for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
        const double ratio = largest(recording.position, joint) / reach(robot.joints[joint]);
        if (ratio > 1) {
            beyond.push_back(joint);
            factor = std::max(factor, ratio);
        }
    }
    if (beyond.empty()) {
        return;
    }
    constexpr double another_unit = 5; // an encoder's error is less than that
    result.fatal = factor > another_unit;
    std::string text("positions of joint ");
    text += joint_list(beyond) + " are up to " + rounded_text(factor) + " times beyond the joints' limits: ";
    text += factor > 2 * degrees    ? "looks like thousandths (mrad, mm)"
            : factor > another_unit ? "looks like degrees"
                                    : "another zero, or another robot";
    result.sentences.push_back(std::move(text));
}

void suspect_clock(const Recording& recording, Suspicions& result) {
    const double step = recording.row_count() < 2 ? 0 : median_step_s(recording);
    if (step > 0.2) {
        result.fatal = true;
        result.sentences.push_back(std::string("rows are ") + rounded_text(step) +
                                   " s apart: the column t looks like milliseconds");
    } else if (step > 0 && step < 2e-5) {
        result.fatal = true;
        result.sentences.push_back(std::string("rows are ") + rounded_text(1e6 * step) +
                                   " µs apart: the column t does not look like seconds");
    }
    const double duration_s =
        recording.row_count() == 0 ? 0 : recording.time_s.back() - recording.time_s.front();
    if (duration_s < least_duration_s) {
        result.fatal = true;
        result.sentences.push_back(std::string("the recording is ") + rounded_text(duration_s) +
                                   " s long: causes need " + rounded_text(least_duration_s) +
                                   " s at least, better 60");
    }
}

void suspect_standstill(const DiagnosisSignals& signals, Suspicions& result) {
    std::vector<std::size_t> standing;
    for (std::size_t joint = 0; joint < signals.joints(); ++joint) {
        const auto column = signals.measured.motion.position.col(static_cast<Eigen::Index>(joint));
        if (column.maxCoeff() - column.minCoeff() < least_travel) {
            standing.push_back(joint);
        }
    }
    if (standing.size() == signals.joints()) {
        result.fatal = true;
        result.sentences.emplace_back(
            "the arm stands still: no cause that depends on motion can be told from another");
    } else if (signals.joints() > 1 && standing.size() + 1 >= signals.joints()) {
        result.sentences.emplace_back(
            "only one joint moves: causes at the others cannot be seen, and many look the same");
    } else if (!standing.empty()) {
        result.sentences.push_back("joint " + joint_list(standing) +
                                   " hardly moves: its own causes cannot be seen");
    }
}

/// Shares of the outputs' variance that the rigid body leaves, a factor and an offset of its own granted to
/// each output.
double unexplained_share(const Eigen::MatrixXd& measured, const Eigen::MatrixXd& nominal) {
    double share = 0;
    for (Eigen::Index output = 0; output < measured.cols(); ++output) {
        const double r = correlation(measured.col(output), nominal.col(output));
        share += 1 - std::max(0.0, r) * r;
    }
    return share / static_cast<double>(measured.cols());
}

void suspect_output_unit(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                         Suspicions& result) {
    std::vector<double> factors;
    for (Eigen::Index output = 0; output < measured.cols(); ++output) {
        const double r = correlation(measured.col(output), signals.nominal.col(output));
        if (r > 0.7) {
            const auto deviation = [](const Eigen::VectorXd& series) {
                return (series.array() - series.mean()).matrix().norm();
            };
            factors.push_back(deviation(measured.col(output)) / deviation(signals.nominal.col(output)));
        }
    }
    if (factors.empty()) {
        return;
    }
    const double factor = median(std::move(factors));
    if (factor > 30 || factor < 1.0 / 30) {
        result.fatal = true;
        result.sentences.push_back(
            "the outputs are " + rounded_text(factor) +
            " times the model's with the same course: another unit, such as mN·m or N·cm");
    }
}

/// Two columns that would fit much better the other way round.
void suspect_exchange(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured, Suspicions& result) {
    const double now = unexplained_share(measured, signals.nominal);
    double best = now;
    std::string words;
    const auto keep = [&](double share, std::string text) {
        if (share < best) {
            best = share;
            words = std::move(text);
        }
    };
    for (Eigen::Index one = 0; one < measured.cols(); ++one) {
        for (Eigen::Index other = 0; other < one; ++other) {
            Eigen::MatrixXd exchanged = measured;
            exchanged.col(one).swap(exchanged.col(other));
            keep(unexplained_share(exchanged, signals.nominal),
                 "outputs " + std::to_string(other + 1) + " and " + std::to_string(one + 1));
        }
    }
    for (Eigen::Index one = 0; one < signals.measured.motion.position.cols(); ++one) {
        for (Eigen::Index other = 0; other < one; ++other) {
            RobotMotion motion = signals.measured.motion;
            for (Eigen::MatrixXd* coordinate : {&motion.position, &motion.velocity, &motion.acceleration}) {
                coordinate->col(one).swap(coordinate->col(other));
            }
            keep(unexplained_share(measured, rigid_outputs(signals.robot, signals.kind, motion)),
                 "positions " + std::to_string(other + 1) + " and " + std::to_string(one + 1));
        }
    }
    const bool clear = now > 0.1 && best < 0.4 * now;
    if (clear) {
        result.fatal = true;
        result.sentences.push_back(words + " look exchanged: the other way round the model leaves " +
                                   rounded_text(100 * best) + " % of the variance instead of " +
                                   rounded_text(100 * now) + " %");
    }
}

/// Share of the outputs' variance that is left when each may be a sum of the rigid body's, of a friction and
/// of a spring.
double foreign_share(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured) {
    double share = 0;
    for (Eigen::Index output = 0; output < measured.cols(); ++output) {
        Eigen::MatrixXd columns(measured.rows(), signals.wrench() ? 2 : 5);
        columns.col(0).setOnes();
        columns.col(1) = signals.nominal.col(output);
        if (!signals.wrench()) {
            const RobotMotion& motion = signals.measured.motion;
            columns.col(2) = motion.position.col(output);
            columns.col(3) = motion.velocity.col(output);
            columns.col(4) = signals.direction(output);
        }
        const Eigen::VectorXd centred = measured.col(output).array() - measured.col(output).mean();
        const Eigen::VectorXd fit = columns.colPivHouseholderQr().solve(centred);
        share += (centred - columns * fit).squaredNorm() / centred.squaredNorm();
    }
    return share / static_cast<double>(measured.cols());
}

void suspect_robot(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured, Suspicions& result) {
    const double left = foreign_share(signals, measured);
    if (left > 0.6) {
        result.fatal = true;
        result.sentences.push_back(
            "the robot's model, with friction, has next to nothing in common with the outputs (" +
            rounded_text(100 * left) +
            " % of their variance is left): another robot, tip, base, mounting or output");
    }
}

} // namespace

Suspicions suspicions_of_file(const Robot& robot, const Recording& recording) {
    Suspicions result;
    suspect_clock(recording, result);
    suspect_position_unit(robot, recording, result);
    return result;
}

Suspicions suspicions_of_motion(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                bool gains_known) {
    Suspicions result;
    suspect_standstill(signals, result);
    if (result.fatal) {
        return result;
    }
    if (gains_known) {
        suspect_output_unit(signals, measured, result);
    }
    if (!result.fatal) {
        suspect_exchange(signals, measured, result);
        suspect_robot(signals, measured, result);
    }
    return result;
}

} // namespace dfdyn::tools
