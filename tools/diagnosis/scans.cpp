// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/scans.hpp"

#include "tools/diagnosis/candidates.hpp"

#include <algorithm>
#include <array>
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
    std::vector<Scored> result;
    for (int cycles = fewest_cycles; cycles <= most_cycles; ++cycles) {
        std::complex<double> product = 0;
        double energy = 0;
        for (Eigen::Index row = 0; row < position.size(); ++row) {
            product += weighed(row, joint) * std::polar(1.0, cycles * position[row]);
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

struct Window {
    double gain = 0, start_s = 0, end_s = 0;
    Eigen::Index output = 0;
};

constexpr double apart_s = 2; ///< windows closer than this tell of the same event

bool same_event(const Window& one, const Window& other) {
    return one.output == other.output && one.start_s < other.end_s + apart_s &&
           other.start_s < one.end_s + apart_s;
}

/// The best window of each event on one output, the best event first.
std::vector<Window> events_of(std::vector<Window> windows) {
    std::ranges::sort(windows, std::greater<>{}, &Window::gain);
    std::vector<Window> events;
    for (const Window& window : windows) {
        if (std::none_of(events.begin(), events.end(),
                         [&](const Window& one) { return same_event(one, window); })) {
            events.push_back(window);
        }
    }
    return events;
}

/// Pulses around a window: its ends moved, its flanks steeper and softer.
std::vector<ContactPulse> pulses_around(const Window& window) {
    const double length = window.end_s - window.start_s;
    std::vector<ContactPulse> pulses;
    for (const double rise : {0.15, 0.3, 0.5}) {
        for (const double early : {0.0, -0.15, 0.15}) {
            for (const double late : {0.0, -0.15, 0.15}) {
                pulses.push_back(
                    {window.start_s + early * length, window.end_s + late * length, rise * length});
            }
        }
    }
    return pulses;
}

/// All windows of one length over one output; counted by `tried`.
void scan_windows(const DiagnosisSignals& signals, const EffectRegression& regression,
                  const Eigen::VectorXd& weighed, Window window, double length_s,
                  std::vector<Window>& found) {
    const Eigen::VectorXd& time = signals.measured.time_s;
    const auto length = static_cast<Eigen::Index>(length_s * signals.measured.rate_hz);
    const Eigen::Index middle = time.size() / 2;
    if (middle + length >= time.size()) {
        return;
    }
    const Eigen::VectorXd series =
        pulse_series(signals, {time[middle], time[middle + length], std::min(0.15, length_s / 2)});
    const Eigen::VectorXd weight = regression.noise().col(window.output).cwiseSqrt().cwiseInverse();
    const double energy = (weight.asDiagonal() * regression.rows().analyse(series)).squaredNorm();
    const Eigen::VectorXd shape = series.segment(middle, length);
    for (Eigen::Index first = 0; first + length < time.size();
         first += std::max<Eigen::Index>(1, length / 8)) {
        const double product = weighed.segment(first, length).dot(shape);
        window.gain = product * product / energy;
        window.start_s = time[first];
        window.end_s = time[first + length];
        found.push_back(window);
    }
}

/// Without what happens around a joint's reversals: there a friction that is not quite right leaves pulses of
/// its own.
Eigen::VectorXd away_from_reversals(const DiagnosisSignals& signals, Eigen::VectorXd series,
                                    Eigen::Index joint) {
    if (signals.wrench()) {
        return series;
    }
    const auto reach = static_cast<Eigen::Index>(0.12 * signals.measured.rate_hz);
    const Eigen::VectorXd velocity = signals.measured.motion.velocity.col(joint);
    for (Eigen::Index row = 1; row < velocity.size(); ++row) {
        if ((velocity[row] > 0) != (velocity[row - 1] > 0)) {
            const Eigen::Index first = std::max<Eigen::Index>(0, row - reach);
            series.segment(first, std::min(2 * reach, series.size() - first)).setZero();
        }
    }
    return series;
}

} // namespace

Eigen::MatrixXd weighed_residual(const EffectRegression& regression, const Eigen::VectorXd& coefficients) {
    const SpectralRows& rows = regression.rows();
    std::vector<Eigen::VectorXd> series;
    for (Eigen::Index output = 0; output < regression.outputs(); ++output) {
        Eigen::MatrixXd left = Eigen::MatrixXd::Zero(rows.bins(), rows.frames());
        left.leftCols(regression.fitted_frames()) =
            regression.weight(output).cwiseProduct(regression.residual(output, coefficients));
        series.push_back(rows.synthesise(left));
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

std::vector<Candidate> scan_contacts(const DiagnosisSignals& signals, const EffectRegression& regression,
                                     const Eigen::MatrixXd& weighed) {
    constexpr std::size_t usual = 3; // an event must stand out against this one of its kind
    std::vector<Candidate> result;
    for (Eigen::Index output = 0; output < regression.outputs(); ++output) {
        const Eigen::VectorXd calm = away_from_reversals(signals, weighed.col(output), output);
        std::vector<Window> windows;
        for (const double length_s : {0.5, 0.75, 1.1, 1.7, 2.5, 3.75}) {
            scan_windows(signals, regression, calm, {0, 0, 0, output}, length_s, windows);
        }
        const std::vector<Window> events = events_of(windows);
        if (events.size() > usual) {
            result.push_back(contact_candidate(signals, output, pulses_around(events.front())));
            result.back().tried = static_cast<double>(windows.size());
            result.back().extra_price = events[usual].gain;
        }
    }
    return result;
}

} // namespace dfdyn::tools
