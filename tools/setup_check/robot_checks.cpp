// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/robot_checks.hpp"

#include "tools/common/number.hpp"
#include "tools/common/quantile.hpp"
#include "tools/setup_check/recording_checks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double degrees = 180 / std::numbers::pi;
constexpr double least_travel = 0.05;         ///< rad (m): a joint that moves less is stationary
constexpr double clearly_explained = 0.5;     ///< share by the rigid body, from which on its gain counts
constexpr double certainly_explained = 0.7;   ///< the same where one output decides alone
constexpr double most_unit_factor = 30;       ///< of another unit, not of a wrong model
constexpr double most_ampere_per_torque = 50; ///< at the joint; gimbal motors without gears have 20

double correlation(const VectorXd& one, const VectorXd& other) {
    const VectorXd a = one.array() - one.mean();
    const VectorXd b = other.array() - other.mean();
    const double scale = a.norm() * b.norm();
    return scale > 0 ? a.dot(b) / scale : 0;
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

std::vector<OutputFit> fits_of(const RigidComparison& comparison, bool spring) {
    std::vector<OutputFit> fits;
    for (Index output = 0; output < comparison.outputs(); ++output) {
        fits.push_back(fit_output(comparison, output, output, spring));
    }
    return fits;
}

void check_output_unit(const RigidComparison& comparison, const std::vector<OutputFit>& fits,
                       bool gains_known, SetupFindings& findings) {
    std::vector<double> gains;
    for (const OutputFit& fit : fits) {
        if (fit.explained > clearly_explained) {
            gains.push_back(std::abs(fit.gain));
        }
    }
    if (gains.empty()) {
        return;
    }
    const double factor = median(std::move(gains));
    if (!gains_known && factor > most_ampere_per_torque) {
        findings.push_back({SetupFault::output_unit, Severity::mistake,
                            "the currents are " + rounded_text(factor) +
                                " per N·m of the robot's model: looks like mA; expected A, divide by 1000"});
    } else if (gains_known && (factor > most_unit_factor || factor < 1 / most_unit_factor)) {
        findings.push_back({SetupFault::output_unit, Severity::mistake,
                            "the outputs are " + rounded_text(factor) +
                                " times the model's with the same course: another unit, such as mN·m or "
                                "N·cm; expected " +
                                (comparison.wrench() ? "N and N·m" : "N·m")});
    }
}

void check_sign(const RigidComparison& comparison, const std::vector<OutputFit>& fits,
                SetupFindings& findings) {
    std::string negative;
    std::size_t count = 0;
    std::size_t positive = 0;
    double power = 0;
    double strongest = 0;
    for (std::size_t k = 0; k < fits.size(); ++k) {
        if (fits[k].explained < clearly_explained) {
            continue;
        }
        if (fits[k].gain > 0) {
            ++positive;
            continue;
        }
        negative += (negative.empty() ? "" : ", ") + comparison.output_names[k];
        ++count;
        power += fits[k].friction_power;
        strongest = std::max(strongest, fits[k].explained);
    }
    if (count == 0 || (count == 1 || positive > 0 ? strongest < certainly_explained : false)) {
        return;
    }
    const bool gravity = positive == 0 && power > 0;
    std::string text =
        "output " + negative + ": expected the sign of the robot's model, found the opposite: ";
    text += gravity               ? "gravity looks upside down, for friction has the right sign; --gravity"
            : comparison.wrench() ? "multiply by -1, or --wrench-direction"
                                  : "multiply by -1, or turn the sign of the joint's position";
    findings.push_back({gravity ? SetupFault::gravity_direction : SetupFault::torque_sign, Severity::mistake,
                        std::move(text)});
}

/// Shares of the outputs' variance that the rigid body leaves, with a free factor and offset for each output.
double unexplained_share(const MatrixXd& measured, const MatrixXd& nominal) {
    double share = 0;
    for (Index output = 0; output < measured.cols(); ++output) {
        const double r = correlation(measured.col(output), nominal.col(output));
        share += 1 - std::max(0.0, r) * r;
    }
    return share / static_cast<double>(measured.cols());
}

/// The reading with two columns exchanged that leaves the least.
struct Exchange {
    double now, best;
    std::string columns;

    void keep(double share, std::string exchanged) {
        if (share < best) {
            best = share;
            columns = std::move(exchanged);
        }
    }
};

std::string pair_text(const char* what, Index other, Index one) {
    return std::string(what) + " " + std::to_string(other + 1) + " and " + std::to_string(one + 1);
}

/// By the rigid body alone, over all outputs.
Exchange rigid_exchange(const RigidComparison& comparison) {
    const double now = unexplained_share(comparison.measured, comparison.nominal);
    Exchange exchange{now, now, {}};
    for (Index one = 0; one < comparison.outputs(); ++one) {
        for (Index other = 0; other < one; ++other) {
            MatrixXd exchanged = comparison.measured;
            exchanged.col(one).swap(exchanged.col(other));
            exchange.keep(unexplained_share(exchanged, comparison.nominal), pair_text("outputs", other, one));
        }
    }
    for (Index one = 0; one < comparison.motion.position.cols(); ++one) {
        for (Index other = 0; other < one; ++other) {
            RobotMotion motion = comparison.motion;
            for (MatrixXd* coordinate : {&motion.position, &motion.velocity, &motion.acceleration}) {
                coordinate->col(one).swap(coordinate->col(other));
            }
            exchange.keep(unexplained_share(comparison.measured,
                                            nominal_outputs(comparison.robot, comparison.kind, motion)),
                          pair_text("positions", other, one));
        }
    }
    return exchange;
}

/// With friction, over the two outputs: for arms whose friction hides the rigid body.
Exchange output_exchange(const RigidComparison& comparison) {
    Exchange worst{1, 1, {}};
    for (Index one = 0; one < comparison.outputs(); ++one) {
        for (Index other = 0; other < one; ++other) {
            const double now =
                fit_output(comparison, one, one, true).left + fit_output(comparison, other, other, true).left;
            const double exchanged =
                fit_output(comparison, one, other, true).left + fit_output(comparison, other, one, true).left;
            if (exchanged / now < worst.best / worst.now) {
                worst = {now / 2, exchanged / 2, pair_text("outputs", other, one)};
            }
        }
    }
    return worst;
}

void check_exchange(const RigidComparison& comparison, SetupFindings& findings) {
    const Exchange rigid = rigid_exchange(comparison);
    const Exchange friction = output_exchange(comparison);
    const bool by_rigid = rigid.now > 0.1 && rigid.best < 0.4 * rigid.now;
    const bool by_friction = friction.now > 0.4 && friction.best < 0.4 * friction.now;
    if (!by_rigid && !by_friction) {
        return;
    }
    const Exchange& found = by_rigid ? rigid : friction;
    findings.push_back({SetupFault::exchanged_columns, Severity::mistake,
                        found.columns + " look exchanged: the other way round the model leaves " +
                            rounded_text(100 * found.best) + " % of the variance instead of " +
                            rounded_text(100 * found.now) + " %; exchange the columns' names"});
}

void check_robot(const std::vector<OutputFit>& fits, SetupFindings& findings) {
    double left = 0;
    for (const OutputFit& fit : fits) {
        left += fit.left / static_cast<double>(fits.size());
    }
    if (left > 0.6) {
        findings.push_back(
            {SetupFault::wrong_robot, Severity::unanswerable,
             "the robot's model, with friction, has next to nothing in common with the outputs (" +
                 rounded_text(100 * left) +
                 " % of their variance is left): another robot, tip, base, mounting or output"});
    }
}

} // namespace

SetupFindings check_position_limits(const Robot& robot, const Recording& recording) {
    std::vector<std::size_t> beyond;
    double factor = 0;
    for (std::size_t joint = 0; joint < robot.joints.size(); ++joint) {
        const double ratio = largest_magnitude(recording.position, joint) / reach(robot.joints[joint]);
        if (ratio > 1) {
            beyond.push_back(joint);
            factor = std::max(factor, ratio);
        }
    }
    if (beyond.empty()) {
        return {};
    }
    constexpr double another_unit = 5; // an encoder's error is less than that
    std::string text = "positions of joint " + joint_list(beyond) + " are up to " + rounded_text(factor) +
                       " times beyond the joints' limits: ";
    text += factor > 2 * degrees    ? "looks like thousandths (mrad, mm); expected rad (m), divide by 1000"
            : factor > another_unit ? "looks like degrees; expected rad, multiply by pi/180"
                                    : "another zero, or another robot";
    return {{SetupFault::position_unit, factor > another_unit ? Severity::mistake : Severity::note,
             std::move(text)}};
}

SetupFindings check_standstill(const MatrixXd& position) {
    const auto joints = static_cast<std::size_t>(position.cols());
    std::vector<std::size_t> standing;
    for (std::size_t joint = 0; joint < joints; ++joint) {
        const auto column = position.col(static_cast<Index>(joint));
        if (column.maxCoeff() - column.minCoeff() < least_travel) {
            standing.push_back(joint);
        }
    }
    const auto finding = [](Severity severity, std::string text) {
        return SetupFindings{{SetupFault::standstill, severity, std::move(text)}};
    };
    if (standing.size() == joints) {
        return finding(Severity::unanswerable,
                       "the arm stands still: no cause that depends on motion can be told from another");
    }
    if (joints > 1 && standing.size() + 1 >= joints) {
        return finding(Severity::note,
                       "only one joint moves: causes at the others cannot be seen, and many look the same");
    }
    if (!standing.empty()) {
        return finding(Severity::note,
                       "joint " + joint_list(standing) + " hardly moves: its own causes cannot be seen");
    }
    return {};
}

SetupFindings check_against_robot(const RigidComparison& comparison, bool gains_known) {
    SetupFindings findings;
    const std::vector<OutputFit> fits = fits_of(comparison, false);
    check_output_unit(comparison, fits, gains_known, findings);
    if (!findings.empty()) {
        return findings;
    }
    check_exchange(comparison, findings);
    if (findings.empty()) {
        check_sign(comparison, fits, findings);
    }
    check_robot(fits_of(comparison, true), findings);
    return findings;
}

} // namespace dfdyn::tools
