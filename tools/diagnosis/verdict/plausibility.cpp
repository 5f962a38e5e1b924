// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/plausibility.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/base/recording/stretches.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/setup_check/setup_check.hpp"

#include <algorithm>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double least_duration_s = 3;

// the diagnosis filters at a few Hz and needs a sufficient sampling rate
constexpr double longest_step_s = 0.2;

void suspect_rate(const Recording& recording, std::vector<Suspicion>& result) {
    if (recording.row_count() >= 2 && !usable_rate(recording)) {
        result.push_back({"rows are " + rounded_text(median_step_s(recording)) +
                              " s apart: a diagnosis needs " + rounded_text(shortest_step_s) + " to " +
                              rounded_text(longest_step_s) + " s",
                          "clock", "t"});
    }
}

/// The last row counts for a step, as the others do.
void suspect_duration(const Recording& recording, std::vector<Suspicion>& result) {
    constexpr double rounding_s = 1e-6;
    const double duration_s = recording.row_count() < 2 ? 0
                                                        : recording.time_s.back() - recording.time_s.front() +
                                                              median_step_s(recording);
    if (duration_s < least_duration_s - rounding_s) {
        result.push_back({std::string("the recording is ") + rounded_text(duration_s) +
                              " s long: a diagnosis needs at least " + rounded_text(least_duration_s) +
                              " s, better 60",
                          "too_little_information", "t"});
    }
}

void suspect_standstill(const DiagnosisSignals& signals, const Recording& recording,
                        std::vector<Suspicion>& result) {
    std::vector<std::size_t> standing;
    for (std::size_t joint = 0; joint < signals.joints(); ++joint) {
        if (signals.hardly_moves(joint)) {
            standing.push_back(joint);
        }
    }
    if (standing.size() == signals.joints()) {
        result.push_back({"the arm is stationary: causes that depend on motion cannot be distinguished",
                          "standing", listed(recording.position.names)});
    } else if (signals.joints() > 1 && standing.size() + 1 >= signals.joints()) {
        result.push_back({"only one joint moves: causes at the others are not observable, and many cannot be "
                          "distinguished"});
    } else if (!standing.empty()) {
        result.push_back(
            {"joint " + counted_from_one(standing) + " hardly moves: its own causes are not observable"});
    }
}

/// Rows of a block of 0.2 s, in which noise averages out and motion hardly does.
Eigen::Index block_rows(const DiagnosisSignals& signals) {
    return std::max(Eigen::Index{1}, static_cast<Eigen::Index>(0.2 * signals.measured.rate_hz));
}

Eigen::MatrixXd block_means(const Eigen::MatrixXd& rows, Eigen::Index size) {
    Eigen::MatrixXd means(rows.rows() / size, rows.cols());
    for (Eigen::Index block = 0; block < means.rows(); ++block) {
        means.row(block) = rows.middleRows(block * size, size).colwise().mean();
    }
    return means;
}

/// Energy that white noise gives to the `means` of blocks, from the variance of the rows within the blocks.
double white_noise_energy(const Eigen::VectorXd& rows, const Eigen::VectorXd& means, Eigen::Index size) {
    if (size < 2) {
        return 0;
    }
    const auto count = static_cast<double>(size);
    const double within = rows.head(means.size() * size).squaredNorm() - count * means.squaredNorm();
    return std::max(0.0, within) / (count * (count - 1));
}

/// Rigid body, friction and spring of an output.
Eigen::MatrixXd own_columns(const DiagnosisSignals& signals, Eigen::Index output) {
    Eigen::MatrixXd columns(signals.rows(), signals.wrench() ? 2 : 5);
    columns.col(0).setOnes();
    columns.col(1) = signals.nominal.col(output);
    if (!signals.wrench()) {
        const RobotMotion& motion = signals.measured.motion;
        columns.col(2) = motion.position.col(output);
        columns.col(3) = motion.velocity.col(output);
        columns.col(4) = signals.direction(output);
    }
    return columns;
}

/// Share of the outputs' variance between blocks that neither white noise nor a fit of the rigid body, a
/// friction and a spring explains. Outputs of joints at rest and constant outputs carry no information
/// about the robot and are skipped.
double foreign_share(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured) {
    constexpr double squared_rounding = 1e-18; // of the squared size
    const Eigen::Index size = block_rows(signals);
    double share = 0;
    int counted = 0;
    for (Eigen::Index output = 0; output < measured.cols(); ++output) {
        const Eigen::VectorXd means = block_means(measured.col(output), size);
        const double varied = (means.array() - means.mean()).square().sum();
        const bool at_rest = !signals.wrench() && signals.hardly_moves(static_cast<std::size_t>(output));
        if (at_rest || !(varied > squared_rounding * means.squaredNorm())) {
            continue;
        }
        const Eigen::MatrixXd columns = own_columns(signals, output);
        const Eigen::VectorXd fit = least_squares(block_means(columns, size), means);
        const Eigen::VectorXd left = measured.col(output) - columns * fit;
        const Eigen::VectorXd left_means = block_means(left, size);
        share +=
            std::max(0.0, left_means.squaredNorm() - white_noise_energy(left, left_means, size)) / varied;
        ++counted;
    }
    return counted > 0 ? share / counted : 0;
}

void suspect_robot(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                   const Recording& recording, std::vector<Suspicion>& result) {
    const double left = foreign_share(signals, measured);
    if (left > 0.6) {
        result.push_back({"the robot's model with friction explains almost nothing of the outputs (" +
                              rounded_text(100 * left) +
                              " % of their variance remains): another robot, tip, base, mounting or output",
                          "wrong_robot", listed(recording.output.names)});
    }
}

} // namespace

bool usable_rate(const Recording& recording) {
    const double step_s = median_step_s(recording);
    return step_s >= shortest_step_s && step_s <= longest_step_s;
}

std::vector<Suspicion> suspicions_of_file(const Recording& recording) {
    std::vector<Suspicion> result;
    suspect_rate(recording, result);
    suspect_duration(recording, result);
    return result;
}

std::vector<Suspicion> suspicions_of_motion(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                                            const Recording& recording) {
    std::vector<Suspicion> result;
    suspect_standstill(signals, recording, result);
    if (result.empty() || result.front().code.empty()) {
        suspect_robot(signals, measured, recording, result);
    }
    return result;
}

} // namespace dfdyn::tools
