// SPDX-License-Identifier: Apache-2.0
#include "tools/setup_check/setup_check.hpp"

#include "tools/common/error.hpp"
#include "tools/common/text.hpp"
#include "tools/recording/stretches.hpp"
#include "tools/setup_check/recording_checks.hpp"
#include "tools/setup_check/robot_checks.hpp"

#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double comparison_step_s = 0.01;
constexpr ZeroPhaseWindow derivative_window{6, 3};
constexpr Eigen::Index fewest_rows = 100;

void append(SetupFindings& findings, SetupFindings&& more) {
    findings.insert(findings.end(), std::make_move_iterator(more.begin()),
                    std::make_move_iterator(more.end()));
}

Columns every_row(const Columns& columns, std::size_t stride, std::size_t rows) {
    Columns result{columns.names, {}};
    for (std::size_t row = 0; columns.present() && row < rows; row += stride) {
        const auto values = columns.row(row);
        result.values.insert(result.values.end(), values.begin(), values.end());
    }
    return result;
}

/// About one row per `comparison_step_s`, positions and outputs only; a gap anywhere between two rows stays
/// one.
Recording thinned(const Recording& recording) {
    const double per_row = std::round(comparison_step_s / median_step_s(recording));
    const auto stride = static_cast<std::size_t>(std::max(1.0, per_row));
    const std::size_t rows = recording.row_count();
    Recording result;
    result.source = recording.source;
    result.position = every_row(recording.position, stride, rows);
    result.output = every_row(recording.output, stride, rows);
    for (std::size_t row = 0; row < rows; row += stride) {
        result.time_s.push_back(recording.time_s[row]);
        result.time_ns.push_back(recording.time_ns[row]);
        const std::size_t last = row < stride ? row : row - stride + 1;
        bool gap = false;
        for (std::size_t i = last; i <= row; ++i) {
            gap = gap || recording.gap_before[i] != 0;
        }
        result.gap_before.push_back(gap ? 1 : 0);
    }
    return result;
}

/// Nothing where too few rows have derivatives, or the arm stands still.
SetupFindings comparison_findings(const Recording& recording, OutputKind outputs, const Robot& robot,
                                  const std::vector<double>& torque_constants) {
    const Recording thin = thinned(recording);
    RecordedMotion recorded;
    try {
        recorded = recorded_motion({&thin, 1}, derivative_window);
    } catch (const InputError&) {
        return {}; // no row with derivatives
    }
    if (recorded.motion.rows() < fewest_rows ||
        any_of_severity(check_standstill(recorded.motion.position), Severity::unanswerable)) {
        return {};
    }
    constexpr double slowest = 2e-3; // rad/s
    const Eigen::VectorXd sign_velocity =
        (0.03 * recorded.motion.velocity.cwiseAbs().colwise().maxCoeff().transpose()).cwiseMax(slowest);
    const bool gains_known = outputs != OutputKind::motor_current || !torque_constants.empty();
    if (outputs == OutputKind::motor_current && gains_known) {
        recorded.outputs *=
            Eigen::Map<const Eigen::VectorXd>(torque_constants.data(), recorded.outputs.cols()).asDiagonal();
    }
    const RigidComparison comparison(robot, outputs, recording.output.names, recorded.motion,
                                     recorded.outputs, sign_velocity);
    return check_against_robot(comparison, gains_known);
}

} // namespace

SetupFindings check_setup(std::span<const Recording> recordings, OutputKind outputs, const Robot* robot,
                          const std::vector<double>& torque_constants) {
    SetupFindings all;
    for (const Recording& recording : recordings) {
        SetupFindings findings = check_recording(recording);
        append(findings, check_units(recording, outputs));
        const bool fits = robot != nullptr && robot->joints.size() == recording.joint_count();
        if (fits && !any_of_severity(findings, Severity::mistake)) {
            append(findings, check_position_limits(*robot, recording));
        }
        const bool constants = torque_constants.empty() || torque_constants.size() == recording.joint_count();
        if (fits && constants && !any_of_severity(findings, Severity::mistake)) {
            append(findings, comparison_findings(recording, outputs, *robot, torque_constants));
        }
        for (SetupFinding& finding : findings) {
            finding.text = shown(recording.source) + ": " + finding.text;
        }
        append(all, std::move(findings));
    }
    return all;
}

void refuse_mistakes(const SetupFindings& findings) {
    for (const SetupFinding& finding : findings) {
        if (finding.severity == Severity::mistake) {
            throw InputError(finding.text + " (--no-setup-check goes on all the same)");
        }
    }
}

} // namespace dfdyn::tools
