// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/scans.hpp"

#include "tools/diagnosis/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>

namespace dfdyn::tools {

namespace {

constexpr int fewest_cycles = 2;
constexpr int most_cycles = 200;

struct Scored {
    double gain = 0;
    int cycles = 0;
};

/// Sum of squares that a ripple would explain, per number of cycles; its energy is taken at the frequency of
/// each instant.
std::vector<Scored> ripple_gains(const DiagnosisSignals& signals, const EffectRegression& regression,
                                 const Eigen::MatrixXd& weighed, Eigen::Index joint) {
    const Eigen::VectorXd position = signals.measured.motion.position.col(joint);
    const Eigen::VectorXd velocity = signals.measured.motion.velocity.col(joint);
    const double bin_hz = 1 / (2 * SpectralRows::hop_s);
    const std::complex<double> turn(0, 1);
    const Eigen::ArrayXcd once = (turn * position.array()).exp();
    Eigen::ArrayXcd phase = (turn * static_cast<double>(fewest_cycles - 1) * position.array()).exp();
    std::vector<Scored> result;
    for (int cycles = fewest_cycles; cycles <= most_cycles; ++cycles) {
        phase *= once;
        const std::complex<double> product = (phase * weighed.col(joint).array()).sum();
        double energy = 0;
        for (Eigen::Index row = 0; row < position.size(); ++row) {
            const double frequency_hz = std::abs(cycles * velocity[row]) / (2 * std::numbers::pi);
            const auto bin = static_cast<Eigen::Index>(frequency_hz / bin_hz);
            energy += bin < regression.rows().bins() ? 0.5 / regression.noise()(bin, joint) : 0;
        }
        result.push_back({energy > 0 ? std::norm(product) / energy : 0, cycles});
    }
    return result;
}

/// The three best local maxima with their neighbours.
std::vector<int> best_cycles(const std::vector<Scored>& gains) {
    std::vector<Scored> peaks;
    for (std::size_t i = 0; i < gains.size(); ++i) {
        const bool above_last = i == 0 || gains[i].gain >= gains[i - 1].gain;
        const bool above_next = i + 1 == gains.size() || gains[i].gain >= gains[i + 1].gain;
        if (above_last && above_next && gains[i].gain > 0) {
            peaks.push_back(gains[i]);
        }
    }
    std::ranges::sort(peaks, std::greater<>{}, &Scored::gain);
    std::set<int> cycles;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, peaks.size()); ++i) {
        for (int near = peaks[i].cycles - 1; near <= peaks[i].cycles + 1; ++near) {
            cycles.insert(std::clamp(near, fewest_cycles, most_cycles));
        }
    }
    return {cycles.begin(), cycles.end()};
}

} // namespace

Eigen::MatrixXd weighed_residual(const EffectRegression& regression, const Eigen::VectorXd& coefficients) {
    const SpectralRows& rows = regression.rows();
    std::vector<Eigen::VectorXd> series;
    for (Eigen::Index output = 0; output < regression.outputs(); ++output) {
        Eigen::MatrixXd left = Eigen::MatrixXd::Zero(rows.bins(), rows.frames());
        left.leftCols(regression.fitted_frames()) =
            regression.weight(output).cwiseProduct(regression.residual(output, coefficients));
        series.push_back(rows.synthesise(left, output));
    }
    Eigen::MatrixXd result(series.front().size(), regression.outputs());
    for (Eigen::Index output = 0; output < regression.outputs(); ++output) {
        result.col(output) = series[static_cast<std::size_t>(output)];
    }
    return result;
}

std::vector<Candidate> scan_ripples(const DiagnosisSignals& signals, const EffectRegression& regression,
                                    const Eigen::MatrixXd& weighed) {
    std::vector<Candidate> result;
    for (std::size_t joint = 0; !signals.wrench() && joint < signals.joints(); ++joint) {
        const std::vector<int> cycles =
            best_cycles(ripple_gains(signals, regression, weighed, static_cast<Eigen::Index>(joint)));
        if (!cycles.empty()) {
            result.push_back(ripple_candidate(signals, joint, cycles));
            result.back().tried = static_cast<double>(most_cycles) / static_cast<double>(cycles.size());
        }
    }
    return result;
}

} // namespace dfdyn::tools
