// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/answered_band.hpp"

#include "tools/diagnosis/spectral_rows.hpp"

#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr Eigen::Index bins_of_band = 6;
constexpr double sure = 3; ///< deviations

/// Least squares of an output on the rigid body's torque, in a band of frequencies.
struct Answer {
    double size = 0, deviation = 0;

    Answer(const Eigen::MatrixXd& torque, const Eigen::MatrixXd& output) {
        const double energy = torque.squaredNorm();
        if (energy > 0) {
            size = torque.cwiseProduct(output).sum() / energy;
            deviation =
                (output - size * torque).norm() / std::sqrt(static_cast<double>(torque.size()) * energy);
        }
    }
};

/// Bins up to the last band that surely answers, if one above it surely does not: by less than half as much
/// as all together.
Eigen::Index answered_bins(const Eigen::MatrixXd& torque, const Eigen::MatrixXd& output) {
    const double half = Answer(torque, output).size / 2;
    Eigen::Index answered = 0;
    bool silent = false;
    for (Eigen::Index first = 0; half > 0 && first + bins_of_band <= torque.rows(); first += bins_of_band) {
        const Answer band(torque.middleRows(first, bins_of_band), output.middleRows(first, bins_of_band));
        if (band.size - sure * band.deviation > half) {
            answered = first + bins_of_band;
            silent = false;
        } else if (band.size + sure * band.deviation < half) {
            silent = true;
        }
    }
    return silent && answered > 0 ? answered : torque.rows();
}

} // namespace

Eigen::VectorXd answered_hz(const DiagnosisSignals& signals) {
    Eigen::VectorXd result = Eigen::VectorXd::Constant(signals.outputs(), 2 * SpectralRows::highest_hz);
    const SpectralRows rows(signals.measured);
    for (Eigen::Index output = 0; !signals.wrench() && output < signals.outputs(); ++output) {
        const Eigen::Index bins = answered_bins(rows.analyse(signals.nominal.col(output), output),
                                                rows.analyse(signals.measured.outputs.col(output), output));
        if (bins < rows.bins()) {
            result[output] = rows.frequency_hz(bins - 1);
        }
    }
    return result;
}

} // namespace dfdyn::tools
