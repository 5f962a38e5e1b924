// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/response_bandwidth.hpp"

#include "tools/diagnosis/signals/spectral_rows.hpp"

#include <Eigen/Cholesky>

#include <cmath>
#include <numbers>

namespace dfdyn::tools {

namespace {

constexpr Eigen::Index bins_of_band = 6;
constexpr double sure_deviations = 3;

/// Spectral coefficients (bins x frames) of a joint's rigid-body torque and of its time derivative.
struct RigidTorque {
    Eigen::MatrixXd value, slope;
};

/// Magnitude of an output's response to the rigid-body torque in a frequency band, for any delay. Least
/// squares on the torque and on its derivative, which is a quarter of a period out of phase.
struct BandResponse {
    double size = 0, deviation = 0;

    BandResponse(const RigidTorque& torque, const Eigen::MatrixXd& output, Eigen::Index first,
                 double middle_hz) {
        Eigen::MatrixXd columns(bins_of_band * output.cols(), 2);
        columns << torque.value.middleRows(first, bins_of_band).reshaped(),
            torque.slope.middleRows(first, bins_of_band).reshaped() / (2 * std::numbers::pi * middle_hz);
        const Eigen::VectorXd wanted = output.middleRows(first, bins_of_band).reshaped();
        const Eigen::LDLT<Eigen::Matrix2d> squares(columns.transpose() * columns);
        if (squares.vectorD().minCoeff() > 0) {
            const Eigen::Vector2d found = squares.solve(columns.transpose() * wanted);
            const double variance =
                (wanted - columns * found).squaredNorm() / static_cast<double>(wanted.size());
            size = found.norm();
            deviation =
                std::sqrt(variance * squares.solve(Eigen::Matrix2d::Identity()).diagonal().maxCoeff());
        }
    }
};

/// Returns the number of bins up to the last band with a significant response. The response is limited only
/// if a higher band has significantly less than half of the overall response; otherwise all bins count.
Eigen::Index responding_bins(const SpectralRows& rows, const RigidTorque& torque,
                             const Eigen::MatrixXd& output) {
    const double half = torque.value.cwiseProduct(output).sum() / torque.value.squaredNorm() / 2;
    Eigen::Index responding = 0;
    bool silent = false;
    for (Eigen::Index first = 0; half > 0 && first + bins_of_band <= rows.bins(); first += bins_of_band) {
        const BandResponse band(torque, output, first, rows.frequency_hz(first + bins_of_band / 2));
        if (band.size - sure_deviations * band.deviation > half) {
            responding = first + bins_of_band;
            silent = false;
        } else if (band.deviation > 0 && band.size + sure_deviations * band.deviation < half) {
            silent = true;
        }
    }
    return silent && responding > 0 ? responding : rows.bins();
}

} // namespace

Eigen::VectorXd response_bandwidth_hz(const DiagnosisSignals& signals) {
    Eigen::VectorXd result = Eigen::VectorXd::Constant(signals.outputs(), 2 * SpectralRows::highest_hz);
    const SpectralRows rows(signals.measured);
    for (Eigen::Index output = 0; !signals.wrench() && output < signals.outputs(); ++output) {
        const Eigen::VectorXd torque = signals.nominal.col(output);
        const Eigen::Index bins =
            responding_bins(rows, {rows.analyse(torque, output), rows.analyse(signals.rate(torque), output)},
                            rows.analyse(signals.measured.outputs.col(output), output));
        if (bins < rows.bins()) {
            result[output] = rows.frequency_hz(bins - 1);
        }
    }
    return result;
}

} // namespace dfdyn::tools
