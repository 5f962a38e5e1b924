// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/recording/panel_band.hpp"

#include "tools/diagnosis/signals/lapped_transform.hpp"
#include "tools/simulation/sensors/low_pass.hpp"

#include <cmath>

namespace dfdyn::tests {

namespace {

constexpr double band_hz = 5;

Eigen::MatrixXd filtered(const Eigen::MatrixXd& rows, double rate_hz) {
    tools::LowPass filter(2, band_hz, 1 / rate_hz);
    Eigen::MatrixXd result(rows.rows(), rows.cols());
    for (Eigen::Index row = 0; row < rows.rows(); ++row) {
        tools::Wrench values = tools::Wrench::Zero();
        values.head(rows.cols()) = rows.row(row).transpose();
        result.row(row) = filter.filter(values).head(rows.cols()).transpose();
    }
    return result;
}

} // namespace

Eigen::MatrixXd in_band(const Eigen::MatrixXd& rows, double rate_hz) {
    const Eigen::MatrixXd backwards = filtered(rows, rate_hz).colwise().reverse();
    return filtered(backwards, rate_hz).colwise().reverse();
}

double band_evidence(const Eigen::MatrixXd& course, const Eigen::MatrixXd& noise, double rate_hz) {
    constexpr double block_s = 2;
    const tools::LappedTransform transform(std::lround(block_s * rate_hz),
                                           std::lround(2 * block_s * band_hz));
    double evidence = 0;
    for (Eigen::Index output = 0; output < noise.cols(); ++output) {
        const Eigen::VectorXd spectrum = transform.analyse(noise.col(output)).rowwise().squaredNorm();
        const Eigen::MatrixXd rows = transform.analyse(course.col(output));
        evidence += 0.5 * static_cast<double>(rows.cols()) *
                    rows.rowwise().squaredNorm().cwiseQuotient(spectrum).sum();
    }
    return evidence;
}

Eigen::VectorXd band_rms(const Eigen::MatrixXd& rows, double rate_hz) {
    const auto edge = static_cast<Eigen::Index>(std::lround(rate_hz / 2));
    const Eigen::MatrixXd band = in_band(rows, rate_hz);
    const auto inner = band.middleRows(edge, band.rows() - 2 * edge);
    return (inner.colwise().squaredNorm() / static_cast<double>(inner.rows())).cwiseSqrt().transpose();
}

} // namespace dfdyn::tests
