// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/checks.hpp"

#include "tools/base/numerics/quantile.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/setup_check/signed_fit.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double most_torque_constant = 500; ///< N·m/A at a joint, behind its gear

/// Returns the ratio of an output to the rigid body's, as a magnitude; empty if the rigid body explains too
/// little.
std::optional<double> size_of(const ArmRecording& arm, const RigidParts& parts, Index k) {
    constexpr double clearly = 0.5;
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

std::string heavy_text(const ArmRecording& arm, double factor) {
    return "columns " + listed(arm.recording.output.names) +
           ": expected outputs of the robot's model, found " + rounded_text(factor) +
           (arm.gains_known ? " times those" : " A per N·m of the model") +
           ", with the same shape over time: the robot's masses look like grams; divide the masses and "
           "inertias in its "
           "file by 1000";
}

} // namespace

SetupFindings check_output_size(const ArmRecording& arm) {
    const RigidParts parts = rigid_parts(arm.robot, arm.kind, arm.recorded.motion);
    std::vector<double> sizes;
    for (Index k = 0; k < arm.counted(); ++k) {
        if (const auto size = size_of(arm, parts, k)) {
            sizes.push_back(*size);
        }
    }
    if (sizes.empty()) {
        return {};
    }
    const auto [least, largest] = std::ranges::minmax(sizes);
    const bool several = sizes.size() > 1 && largest < 10 * least && !arm.wrench();
    const double factor = median(std::move(sizes));
    const double too_large = arm.gains_known ? (several ? 50.0 : 300.0) : (several ? 50.0 : 200.0);
    const double too_small = 1 / (arm.gains_known ? too_large : most_torque_constant);
    if (factor < too_large && factor > too_small) {
        return {};
    }
    // a payload can dominate one joint, but never makes an output much smaller
    const bool certain = several || arm.wrench() || arm.counted() == 1 || factor < too_small;
    const Severity severity = certain ? Severity::mistake : Severity::warning;
    const std::string columns = listed(arm.recording.output.names);
    if (factor < too_small && !arm.wrench()) {
        return {{SetupFault::wrong_robot, severity, columns, heavy_text(arm, factor)}};
    }
    return {{SetupFault::output_unit, severity, columns, unit_text(arm, factor)}};
}

} // namespace dfdyn::tools
