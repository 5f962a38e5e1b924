// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/verdict/nuisance_estimates.hpp"

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/verdict/found_parameters.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <optional>
#include <vector>

namespace dfdyn::tools {

namespace {

/// Half the width of a factor's interval.
double factor_reach(const EffectFit& fit, Eigen::Index number) {
    return reach_of_95(std::sqrt(fit.covariance(number, number)), fit.coefficients[number]);
}

FoundParameter mass_parameter(double nominal, double factor, double reach) {
    return {"mass", "kg", nominal * factor, nominal * (factor - reach), nominal * (factor + reach)};
}

/// A joint has `gain` times the factor in A per N·m. If the factor's interval includes zero, the torque
/// constant has no upper limit.
FoundParameter constant_parameter(double gain, double factor, double reach) {
    constexpr double endless = std::numeric_limits<double>::infinity();
    return {"torque_constant", "N·m/A", 1 / (gain * factor), 1 / (gain * (factor + reach)),
            factor > reach ? 1 / (gain * (factor - reach)) : endless};
}

} // namespace

std::vector<NuisanceEstimate> estimate_nuisances(const DiagnosisSignals& signals,
                                                 const FittedEffects& fitted_effects,
                                                 const Eigen::VectorXd& torque_gains) {
    const Eigen::VectorXd nominal = nominal_parameters(signals.robot, signals.kind);
    const Eigen::Index bodies = fitted_effects.uncertain_masses;
    std::vector<NuisanceEstimate> result;
    for (Eigen::Index i = 0; i < std::ssize(fitted_effects.nuisance); ++i) {
        const double factor = fitted_effects.nuisance_factor(i);
        const double reach = factor_reach(fitted_effects.values, i);
        if (i < bodies) {
            const double mass = nominal[10 * i];
            result.push_back(
                {place_text(PlaceKind::link, signals.link_of(i)), mass_parameter(mass, factor, reach), mass});
        } else {
            result.push_back({place_text(PlaceKind::actuator, static_cast<std::size_t>(i - bodies)),
                              constant_parameter(torque_gains[i - bodies], factor, reach), std::nullopt});
        }
    }
    return result;
}

} // namespace dfdyn::tools
