// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/search/candidate_entry.hpp"
#include "tools/diagnosis/search/fitted_effects.hpp"
#include "tools/diagnosis/signals/signals.hpp"
#include "tools/diagnosis/signals/spectral_rows.hpp"

#include <cstddef>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Parameters that every model has and that are no finding: errors of the links' masses, unknown torque
/// constants, and the way in which friction builds up after a reversal. No simulation has the latter exactly.
/// The search assumes that it has, because these columns would compete with its candidates. The evidence of
/// what it found is then computed without this assumption: the error at each reversal resembles a delay, a
/// dependence on load or an inertia.
class NuisanceParameters {
  public:
    /// Sets the members of `fitted` that describe the parameters.
    NuisanceParameters(const DiagnosisSignals& signals, const SpectralRows& rows, bool gains_known,
                       FittedEffects& fitted);

    const std::vector<SpectralColumnPointer>& columns() const { return columns_; }

    /// Returns the priors: friction has its full size after a short way. The parameters have the first
    /// columns of the normal equations.
    std::vector<NuisanceColumn> priors() const;
    /// Returns the nuisance parameters of a model, with priors that allow the friction that it has at each
    /// joint to build up over any short way.
    std::vector<NuisanceColumn> priors_with_lags(const DiagnosisSignals& signals,
                                                 const FittedEffects& fitted) const;

  private:
    /// A parameter of a joint's friction.
    struct Lag {
        std::size_t number; ///< of the parameter
        std::string family; ///< of the joint's friction (Candidate::family)
    };

    std::vector<SpectralColumnPointer> columns_;
    std::vector<double> deviations_;
    std::vector<Lag> lags_;
};

} // namespace dfdyn::tools
