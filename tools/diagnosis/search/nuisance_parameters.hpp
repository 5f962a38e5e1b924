// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/search/candidate_entry.hpp"
#include "tools/diagnosis/search/fitted_effects.hpp"
#include "tools/diagnosis/signals/signals.hpp"
#include "tools/diagnosis/signals/spectral_rows.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Returns a model with nuisance columns only: of the links' masses and, unless `gains_known`, of the
/// outputs' gains.
FittedEffects model_without_effects(const DiagnosisSignals& signals, bool gains_known);

/// Parameters of a model that are no finding. All models have errors of the links' masses and unknown torque
/// constants. The way in which friction builds up after a reversal, its lag, is in no simulation exactly. The
/// search has no lags, because their columns would compete with its candidates. The evidence of what it found
/// is then also computed with them: the error at each reversal resembles a delay, a dependence on load or an
/// inertia.
class NuisanceParameters {
  public:
    /// `model`: with all nuisance columns, as from `model_without_effects`.
    NuisanceParameters(const DiagnosisSignals& signals, const SpectralRows& rows, const FittedEffects& model);

    /// Returns the first columns of the normal equations: masses, gains, lags.
    const std::vector<SpectralColumnPointer>& columns() const { return columns_; }
    /// Returns the parameters of all models, with their priors: masses and gains.
    std::vector<NuisanceColumn> priors() const;
    /// Returns the lags, with priors by the dry friction of a model.
    std::vector<NuisanceColumn> lags(const DiagnosisSignals& signals, const FittedEffects& fitted) const;

  private:
    std::vector<SpectralColumnPointer> columns_;
    std::vector<double> deviations_;      ///< of the first columns: masses and gains
    std::vector<std::string> lag_joints_; ///< of the other columns: where the friction acts
};

} // namespace dfdyn::tools
