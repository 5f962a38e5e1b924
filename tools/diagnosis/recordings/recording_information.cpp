// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/recording_information.hpp"

#include "tools/diagnosis/verdict/textbook.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One joint's rows of a recording.
struct JointRows {
    std::vector<Index> unknowns;
    MatrixXd columns;
    VectorXd target, weight, robust; ///< `robust`: the weight, reduced for large residuals
    double variance = 1, correlated = 1;

    /// Estimates the noise and the robust weights from the residual of these values.
    void take_residual(const VectorXd& values, double rate_hz) {
        constexpr double huber_deviations = 3;
        const VectorXd residual = target - columns * values(unknowns);
        variance = std::max(weighted_mean_square(residual, robust), 1e-12);
        const VectorXd allowed =
            huber_deviations * std::sqrt(variance) * residual.cwiseAbs().cwiseMax(1e-12).cwiseInverse();
        robust = weight.cwiseProduct(allowed.cwiseMin(1));
        variance = std::max(weighted_mean_square(residual, robust), 1e-12);
        correlated = correlated_rows(residual, robust, rate_hz);
    }
};

/// Returns the rows of a joint, with weight 0 if it hardly moves.
JointRows rows_of(const DiagnosisSignals& signals, const MatrixXd& measured, const MatrixXd& terms,
                  Index joint) {
    JointRows rows;
    rows.unknowns = unknowns_of(signals, joint);
    rows.columns = arm_columns(signals, joint, terms);
    rows.target = measured.col(joint) - signals.nominal.col(joint);
    rows.weight = moving_weight(signals, joint);
    rows.robust = rows.weight;
    return rows;
}

RecordingInformation sum_of(const std::vector<JointRows>& joints, Index size) {
    RecordingInformation sum{MatrixXd::Zero(size, size), VectorXd::Zero(size)};
    for (const JointRows& joint : joints) {
        const MatrixXd weighted =
            (joint.robust / (joint.variance * joint.correlated)).asDiagonal() * joint.columns;
        sum.information(joint.unknowns, joint.unknowns) += joint.columns.transpose() * weighted;
        sum.moment(joint.unknowns) += weighted.transpose() * joint.target;
    }
    return sum;
}

} // namespace

double correlated_rows(const VectorXd& residual, const VectorXd& weight, double rate_hz) {
    constexpr double least_s = 0.1, most_s = 1;
    const VectorXd weighted = weight.cwiseProduct(residual);
    const double square = weighted.squaredNorm();
    double sum = 1;
    const auto most = std::min<Index>(static_cast<Index>(most_s * rate_hz), residual.size() - 1);
    for (Index lag = 1; lag <= most && square > 0; ++lag) {
        const Index count = residual.size() - lag;
        const double correlation = weighted.head(count).dot(weighted.tail(count)) / square;
        if (correlation < 0) {
            break;
        }
        sum += 2 * correlation;
    }
    return std::clamp(sum, std::max(1.0, least_s * rate_hz), std::max(1.0, most_s * rate_hz));
}

RecordingInformation information_of(const DiagnosisSignals& signals, const MatrixXd& measured,
                                    const std::vector<MatrixXd>& terms) {
    constexpr int rounds = 4; // the noise estimate has converged
    const Index size = first_term(signals, signals.outputs());
    std::vector<JointRows> joints;
    for (Index joint = 0; joint < signals.outputs(); ++joint) {
        joints.push_back(rows_of(signals, measured, terms[static_cast<std::size_t>(joint)], joint));
        joints.back().take_residual(VectorXd::Zero(size), signals.measured.rate_hz);
    }
    VectorXd prior = VectorXd::Constant(size, 1 / (unknown_deviation * unknown_deviation));
    prior.head(signals.regressor.cols()) = link_deviations(signals).cwiseAbs2().cwiseInverse();
    for (int round = 0; round < rounds; ++round) {
        const RecordingInformation all = sum_of(joints, size);
        const VectorXd values = (all.information + MatrixXd(prior.asDiagonal())).ldlt().solve(all.moment);
        for (JointRows& joint : joints) {
            joint.take_residual(values, signals.measured.rate_hz);
        }
    }
    return sum_of(joints, size);
}

} // namespace dfdyn::tools
