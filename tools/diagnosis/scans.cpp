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
constexpr int most_cycles = 330; // harmonic drives up to 1:160 make twice their ratio

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

/// What is left of an output (bins x fitted frames), weighed, in time.
Eigen::VectorXd weighed_series(const EffectRegression& regression, Eigen::Index output,
                               const Eigen::MatrixXd& left) {
    const SpectralRows& rows = regression.rows();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rows.bins(), rows.frames());
    all.leftCols(left.cols()) = regression.weight(output).cwiseProduct(left);
    return rows.synthesise(all, output);
}

/// Rows within 0.12 s of a change of the sign.
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

/// A straight line in the place of each run of rows that are `away`, from the mean of `beside` rows before it
/// to that of as many behind; level where the series ends.
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

Eigen::MatrixXd weighed_residual(const EffectRegression& regression, const Eigen::VectorXd& coefficients) {
    Eigen::MatrixXd result(regression.rows().rows(), regression.outputs());
    for (Eigen::Index output = 0; output < regression.outputs(); ++output) {
        result.col(output) = weighed_series(regression, output, regression.residual(output, coefficients));
    }
    return result;
}

Eigen::MatrixXd weighed_residual_away_from_reversals(const DiagnosisSignals& signals,
                                                     const EffectRegression& regression,
                                                     const Eigen::VectorXd& coefficients) {
    if (signals.wrench()) {
        return weighed_residual(regression, coefficients);
    }
    const SpectralRows& rows = regression.rows();
    const auto beside = static_cast<Eigen::Index>(0.1 * signals.measured.rate_hz);
    Eigen::MatrixXd result(rows.rows(), regression.outputs());
    for (Eigen::Index output = 0; output < regression.outputs(); ++output) {
        Eigen::MatrixXd left = Eigen::MatrixXd::Zero(rows.bins(), rows.frames());
        left.leftCols(regression.fitted_frames()) = regression.residual(output, coefficients);
        Eigen::VectorXd series = rows.synthesise(left, output);
        // bridged before it is weighed: pieces cut out of what is mostly high frequencies look like pushes
        bridge(series, near_reversals(signals.measured.motion.velocity.col(output), signals.measured.rate_hz),
               beside);
        result.col(output) =
            weighed_series(regression, output, rows.analyse(series).leftCols(regression.fitted_frames()));
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
