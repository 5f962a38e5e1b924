// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/weighted_residual.hpp"

#include <algorithm>
#include <vector>

namespace dfdyn::tools {

namespace {

/// Returns the weighted residual of an output (`left`: bins x fitted frames) as a time series.
Eigen::VectorXd weighted_series(const EffectRegression& regression, Eigen::Index output,
                                const Eigen::MatrixXd& left) {
    const SpectralRows& rows = regression.rows();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows.bins(), rows.frames());
    all.leftCols(left.cols()) = regression.weight(output).cwiseProduct(left);
    return rows.synthesise(all, output);
}

/// Marks the rows within 0.12 s of a change of the velocity's sign.
std::vector<bool> near_reversals(const Eigen::VectorXd& velocity, double rate_hz) {
    const auto reach = static_cast<Eigen::Index>(0.12 * rate_hz);
    std::vector<bool> near(static_cast<std::size_t>(velocity.size()), false);
    for (Eigen::Index row = 1; row < velocity.size(); ++row) {
        if ((velocity[row] > 0) != (velocity[row - 1] > 0)) {
            const Eigen::Index first = std::max<Eigen::Index>(0, row - reach);
            std::fill_n(near.begin() + first, std::min(2 * reach, velocity.size() - first), true);
        }
    }
    return near;
}

/// Replaces each run of rows that are `away` by a straight line. The line connects the means of the `beside`
/// rows before and after it. At the ends of the series it is constant.
void bridge(Eigen::VectorXd& series, const std::vector<bool>& away, Eigen::Index beside) {
    const auto is_away = [&](Eigen::Index row) { return away[static_cast<std::size_t>(row)]; };
    for (Eigen::Index first = 0; first < series.size(); ++first) {
        Eigen::Index last = first;
        while (last < series.size() && is_away(last)) {
            ++last;
        }
        if (last == first) {
            continue;
        }
        Eigen::Index behind = 0;
        while (behind < beside && last + behind < series.size() && !is_away(last + behind)) {
            ++behind;
        }
        const Eigen::Index before = std::min(beside, first);
        const double right = behind > 0 ? series.segment(last, behind).mean() : 0;
        const double left = before > 0 ? series.segment(first - before, before).mean() : right;
        series.segment(first, last - first).setLinSpaced(left, behind > 0 ? right : left);
        first = last;
    }
}

} // namespace

Eigen::MatrixXd weighted_residual(const EffectRegression& regression, const Eigen::VectorXd& coefficients) {
    Eigen::MatrixXd result(regression.rows().rows(), regression.outputs());
    for (Eigen::Index output = 0; output < regression.outputs(); ++output) {
        result.col(output) = weighted_series(regression, output, regression.residual(output, coefficients));
    }
    return result;
}

Eigen::MatrixXd weighted_residual_away_from_reversals(const DiagnosisSignals& signals,
                                                      const EffectRegression& regression,
                                                      const Eigen::VectorXd& coefficients) {
    if (signals.wrench()) {
        return weighted_residual(regression, coefficients);
    }
    const SpectralRows& rows = regression.rows();
    const auto beside = static_cast<Eigen::Index>(0.1 * signals.measured.rate_hz);
    Eigen::MatrixXd result(rows.rows(), regression.outputs());
    for (Eigen::Index output = 0; output < regression.outputs(); ++output) {
        Eigen::MatrixXd left = Eigen::MatrixXd::Zero(rows.bins(), rows.frames());
        left.leftCols(regression.fitted_frames()) = regression.residual(output, coefficients);
        Eigen::VectorXd series = rows.synthesise(left, output);
        // before weighting: pieces cut out of a high-frequency signal resemble contact pulses
        bridge(series, near_reversals(signals.measured.motion.velocity.col(output), signals.measured.rate_hz),
               beside);
        result.col(output) =
            weighted_series(regression, output, rows.analyse(series).leftCols(regression.fitted_frames()));
    }
    return result;
}

} // namespace dfdyn::tools
