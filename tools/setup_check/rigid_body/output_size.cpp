// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/checks.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/setup_check/rigid_body/signed_fit.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double most_torque_constant = 500; ///< N·m/A at a joint, behind its gear
constexpr double largest_gear_ratio = 300;
constexpr double suspicious = 8; ///< a gear ratio or a unit: errors of masses are smaller

/// Returns the ratio of an output to the rigid body's, as a magnitude; empty if the rigid body explains too
/// little. Without gravity and several reversals inertia looks like friction of an unknown shape.
std::optional<double> size_of(const ArmRecording& arm, const RigidParts& parts, Index k) {
    constexpr double clearly = 0.5;
    if (!arm.wrench() && parts.gravity.col(k).isZero(0) && !swings(arm.recorded.motion, k, certain_turns)) {
        return std::nullopt;
    }
    const VectorXd output = arm.output(k);
    const MatrixXd friction =
        arm.wrench() ? MatrixXd(output.size(), 0) : friction_columns(arm.recorded.motion, k);
    const double without = fit_signed(output, friction, MatrixXd(output.size(), 0)).left;
    for (const double sign : {1.0, -1.0}) {
        const SignedFit fit = fit_signed(output, friction, sign * parts.sum(k));
        if (fit.left < clearly * without) {
            return fit.coefficients[0];
        }
    }
    return std::nullopt;
}

std::vector<double> known(const OutputSizes& sizes) {
    std::vector<double> result;
    for (const std::optional<double>& size : sizes) {
        if (size) {
            result.push_back(*size);
        }
    }
    return result;
}

std::string unit_text(const ArmRecording& arm, double factor) {
    const std::string found = "columns " + listed(arm.recording.output.names) + ": expected " +
                              (!arm.gains_known ? "A"
                               : arm.wrench()   ? "N and N·m"
                                                : "N·m") +
                              ", found " + rounded_text(factor);
    if (!arm.gains_known) {
        return found + " A per N·m of the robot's model: looks like mA; " + unit_remedy("i", "mA");
    }
    return found +
           " times the outputs of the robot's model, with the same shape over time: another unit, such as " +
           (arm.kind == OutputKind::motor_current ? "mA, or torque constants of the motor, not of the joint"
            : arm.wrench()                        ? "mN"
                                                  : "mN·m or N·cm") +
           "; convert it (--units)";
}

/// For torques between those of the motors and those of the joints.
std::string other_scale_text(const ArmRecording& arm, double factor) {
    const bool current = arm.kind == OutputKind::motor_current;
    return "columns " + listed(arm.recording.output.names) +
           ": expected outputs of the robot's model, found " + rounded_text(factor) +
           " times those, with the same shape over time: " +
           (factor > 1
                ? std::string(current ? "torque constants" : "another unit, such as kgf·cm or lbf·in") +
                      ", a payload that the robot's file lacks, rotors (screws) whose inertia it lacks, or "
                      "masses in it that are too small"
                : std::string(current ? "torque constants of the motors"
                                      : "torques of the motors (multiply them by the gear ratios)") +
                      ", another unit, or masses in the robot's file that are too large");
}

/// Returns the sizes of the outputs whose shape is that of gravity and whose joint moves. Without gravity a
/// rotor can make an output many times as large as the links do.
OutputSizes sizes_by_gravity(const ArmRecording& arm, const RigidParts& parts, const OutputSizes& sizes) {
    const VectorXd weight = deviations(parts.gravity);
    const VectorXd inertia = deviations(parts.inertia);
    OutputSizes result;
    for (Index k = 0; k < arm.counted(); ++k) {
        if (weight[k] > least_gravity_share * weight.maxCoeff() && weight[k] > inertia[k] &&
            swings(arm.recorded.motion, k, 1)) {
            result.push_back(sizes[static_cast<std::size_t>(k)]);
        }
    }
    return result;
}

/// Returns the largest ratio of an output to the rigid body's with the heaviest plausible payload. A payload
/// can make a wrist's output a hundred times as large as the file's, but no output larger than this.
double factor_with_payload(const ArmRecording& arm, const RigidParts& parts, const OutputSizes& sizes) {
    const MatrixXd unloaded = parts.gravity + parts.inertia;
    const VectorXd by_file = deviations(unloaded);
    VectorXd largest = by_file;
    for (const MatrixXd& loaded : parts.loaded) {
        largest = largest.cwiseMax(deviations(loaded + parts.inertia));
    }
    double factor = 0;
    for (Index k = 0; k < arm.counted(); ++k) {
        if (const std::optional<double>& size = sizes[static_cast<std::size_t>(k)]) {
            factor = std::max(factor, *size * by_file[k] / largest[k]);
        }
    }
    return factor;
}

std::string heavy_text(const ArmRecording& arm, double factor) {
    return "columns " + listed(arm.recording.output.names) +
           ": expected outputs of the robot's model, found " + rounded_text(factor) +
           (arm.gains_known ? " times those" : " A per N·m of the model") +
           ", with the same shape over time: the robot's masses look like grams; divide the masses and "
           "inertias in its file by 1000";
}

} // namespace

OutputSizes output_sizes(const ArmRecording& arm, const RigidParts& parts) {
    OutputSizes sizes;
    for (Index k = 0; k < arm.counted(); ++k) {
        sizes.push_back(size_of(arm, parts, k));
    }
    return sizes;
}

SetupFindings check_output_size(const ArmRecording& arm, const RigidParts& parts, const OutputSizes& sizes) {
    std::vector<double> values = known(sizes);
    if (values.empty()) {
        return {};
    }
    const auto [least, largest] = std::ranges::minmax(values);
    const bool several = values.size() > 1 && largest < 10 * least && !arm.wrench();
    const double factor = median(std::move(values));
    const double too_large = arm.gains_known ? (several ? 50.0 : 300.0) : (several ? 50.0 : 200.0);
    const double too_small = 1 / (arm.gains_known ? too_large : most_torque_constant);
    if (factor < too_large && factor > too_small) {
        return {};
    }
    // a payload or a rotor can dominate some joints, but never makes an output much smaller
    const bool payload = factor >= too_large && factor_with_payload(arm, parts, sizes) < suspicious;
    const bool certain = !payload && (several || arm.wrench() || arm.counted() == 1 || factor < too_small);
    const Severity severity = certain ? Severity::mistake : Severity::warning;
    const std::string columns = listed(arm.recording.output.names);
    if (factor > too_small || arm.wrench()) {
        return {{SetupFault::output_unit, severity, columns,
                 unit_text(arm, factor) + (payload ? ", or a payload that the file lacks" : "")}};
    }
    if (arm.gains_known && factor * largest_gear_ratio > 1) {
        return {{SetupFault::output_unit, severity, columns, other_scale_text(arm, factor)}};
    }
    return {{SetupFault::wrong_robot, severity, columns, heavy_text(arm, factor)}};
}

SetupFindings check_output_scale(const ArmRecording& arm, const RigidParts& parts, const OutputSizes& sizes) {
    if (!arm.gains_known || arm.wrench()) {
        return {};
    }
    // a rotor that the file lacks can dominate the other joints
    const OutputSizes by_gravity = sizes_by_gravity(arm, parts, sizes);
    std::vector<double> values = known(by_gravity);
    if (values.empty()) {
        values = known(sizes);
    }
    const double factor = values.empty() ? 1 : median(std::move(values));
    if (factor < suspicious && factor > 1 / suspicious) {
        return {};
    }
    const auto agree = std::ranges::count_if(by_gravity, [&](const std::optional<double>& size) {
        return size && *size > factor / 2 && *size < 2 * factor;
    });
    // a payload can make outputs of the joints near the tip too large, but none too small
    const bool certain = factor < 1 && agree > 1 && 2 * agree > std::ssize(by_gravity);
    return {{SetupFault::output_unit, certain ? Severity::mistake : Severity::warning,
             listed(arm.recording.output.names), other_scale_text(arm, factor)}};
}

} // namespace dfdyn::tools
