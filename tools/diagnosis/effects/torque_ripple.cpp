// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/sliding.hpp"
#include "tools/diagnosis/candidates/weighted_residual.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/effects/effect_internals.hpp"
#include "tools/diagnosis/extension/extension_parts.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <set>

namespace dfdyn::tools {

namespace {

constexpr ParameterKind ripple_amplitude{"amplitude", "N·m"};
constexpr ParameterKind ripple_cycles{cycles_per_turn, "1"};
constexpr ParameterKind ripple_phase{"phase", "rad"};

constexpr int fewest_cycles = 2;
constexpr int most_cycles = 330; // harmonic drives up to 1:160 cause two cycles per motor turn

struct RippleFit {
    double explained = 0;
    int cycles = 0;
};

/// Sum of squares that a ripple would explain, for each number of cycles per turn. The noise level is that of
/// the ripple's current frequency.
std::vector<RippleFit> ripple_fits(const DiagnosisSignals& signals, const EffectRegression& regression,
                                   const Eigen::MatrixXd& weighted, Eigen::Index joint) {
    const Eigen::ArrayXd position = signals.measured.motion.position.col(joint);
    const Eigen::ArrayXd velocity = signals.measured.motion.velocity.col(joint);
    const Eigen::ArrayXd wave_energy = 0.5 / regression.noise().col(joint).array(); // per bin
    const double bin_hz = 1 / (2 * SpectralRows::hop_s);
    const std::complex<double> turn(0, 1);
    const Eigen::ArrayXcd once = (turn * position).exp();
    Eigen::ArrayXcd phase = (turn * static_cast<double>(fewest_cycles - 1) * position).exp();
    std::vector<RippleFit> result;
    for (int cycles = fewest_cycles; cycles <= most_cycles; ++cycles) {
        phase *= once;
        const std::complex<double> product = (phase * weighted.col(joint).array()).sum();
        const Eigen::ArrayXd bins = (cycles * velocity).abs() / (2 * std::numbers::pi) / bin_hz;
        double energy = 0;
        for (const double at : bins) {
            const auto bin = static_cast<Eigen::Index>(at);
            energy += bin < wave_energy.size() ? wave_energy[bin] : 0;
        }
        result.push_back({energy > 0 ? std::norm(product) / energy : 0, cycles});
    }
    return result;
}

/// Returns the three best local maxima and their neighbours.
std::vector<int> best_cycles(const std::vector<RippleFit>& fits) {
    std::vector<RippleFit> peaks;
    for (std::size_t i = 0; i < fits.size(); ++i) {
        const bool above_last = i == 0 || fits[i].explained >= fits[i - 1].explained;
        const bool above_next = i + 1 == fits.size() || fits[i].explained >= fits[i + 1].explained;
        if (above_last && above_next && fits[i].explained > 0) {
            peaks.push_back(fits[i]);
        }
    }
    std::ranges::sort(peaks, std::greater<>{}, &RippleFit::explained);
    std::set<int> cycles;
    for (std::size_t i = 0; i < std::min<std::size_t>(3, peaks.size()); ++i) {
        for (int near = peaks[i].cycles - 1; near <= peaks[i].cycles + 1; ++near) {
            cycles.insert(std::clamp(near, fewest_cycles, most_cycles));
        }
    }
    return {cycles.begin(), cycles.end()};
}

class RippleScan : public EffectScan {
  public:
    /// Returns, for each joint, the whole numbers of cycles per turn that explain most of the residual. Each
    /// candidate has such numbers and their neighbours as shapes. Only numbers whose frequency is within the
    /// analysed band are considered.
    std::vector<Candidate> candidates(const FittedResidual& residual) const override {
        const DiagnosisSignals& signals = residual.signals;
        // without the unnamed effects: a free function of the position can hide a ripple
        const Eigen::MatrixXd weighted = weighted_residual(residual.regression, residual.named);
        std::vector<Candidate> result;
        for (std::size_t joint = 0; !signals.wrench() && joint < signals.joints(); ++joint) {
            if (signals.robot.joints[joint].prismatic) {
                continue; // a slide has no turns
            }
            const std::vector<int> cycles = best_cycles(
                ripple_fits(signals, residual.regression, weighted, static_cast<Eigen::Index>(joint)));
            if (!cycles.empty()) {
                result.push_back(ripple_candidate(signals, joint, cycles));
                result.back().prior_trials =
                    static_cast<double>(most_cycles) / static_cast<double>(cycles.size());
            }
        }
        return result;
    }
};

/// A wave with any phase is the sum of a sine and a cosine.
EffectDisposition extend_by_ripple(ModelExtension& extension, const ChosenEffect& chosen) {
    EffectModel wave = on_joint(chosen, effect_kinds::torque_ripple);
    wave.cycles_per_rev = chosen.shape.value;
    const double amplitude = chosen.coefficients.norm();
    for (Eigen::Index part = 0; part < 2; ++part) {
        wave.phase = part == 0 ? 0 : std::numbers::pi / 2;
        add_column(extension, wave, chosen.coefficients[part],
                   std::max(chosen.deviations[part], 0.1 * amplitude));
    }
    return EffectDisposition::adapting;
}

} // namespace

Candidate ripple_candidate(const DiagnosisSignals& signals, std::size_t number,
                           const std::vector<int>& cycles) {
    const JointSignals joint(signals, number);
    Candidate result = joint.candidate();
    for (const int count : cycles) {
        const Eigen::ArrayXd angle = joint.position.array() * count;
        result.shapes.push_back(
            {{result.columns.size(), result.columns.size() + 1}, is_anything, static_cast<double>(count)});
        result.columns.push_back(joint.column(angle.sin()));
        result.columns.push_back(joint.column(angle.cos()));
    }
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        return std::vector{ripple_amplitude.at(coefficients.norm()), ripple_cycles.at(shape.value),
                           ripple_phase.at(std::atan2(coefficients[1], coefficients[0]))};
    };
    return result;
}

Effect effects::torque_ripple() {
    return {.name = "torque_ripple",
            .where = "jointK",
            .parameters = {ripple_amplitude, ripple_cycles, ripple_phase},
            .evidence = "repeats with the joint's angle",
            .experiment = "turn this joint slowly through a full turn in both directions and count the waves",
            .in_extended_model = "adapting; the cycles are constant",
            .kept_while_chosen = true,
            .scan = [](const DiagnosisSignals&, const SpectralRows&) -> std::unique_ptr<EffectScan> {
                return std::make_unique<RippleScan>();
            },
            .plotted_over = over_angle,
            .extend = extend_by_ripple};
}

} // namespace dfdyn::tools
