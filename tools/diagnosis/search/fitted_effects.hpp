// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/candidates/effect_regression.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/search/effect_search.hpp"
#include "tools/diagnosis/signals/signals.hpp"

#include <functional>
#include <span>
#include <vector>

namespace dfdyn::tools {

struct FitOptions {
    bool gains_known = true; ///< false: every joint has an unknown gain, which is a nuisance parameter
    double fitted_share = 1; ///< of the recording's time, from its beginning; the rest is held out
    std::function<void(int round)> progress = {};
    std::span<const Effect> effects = effect_catalogue(); ///< that can be named; must outlive the search
};

/// Model of the difference between a measurement and the rigid body.
struct FittedEffects {
    std::vector<Candidate> candidates;
    std::vector<ChosenShape> chosen; ///< of `candidates`, named ones first
    SearchProblem problem;
    EffectFit fit;    ///< fit of all chosen effects
    EffectFit named;  ///< fit of the named effects only, without influence of the unnamed ones
    EffectFit values; ///< of the named effects: the coefficients that are reported (`make_robust`)
    /// Number of links with uncertain mass, the first nuisance parameters: all or none.
    Eigen::Index uncertain_masses = 0;
    Eigen::MatrixXd noise; ///< bins x m: spectra of the residual
    std::vector<EffectColumn> nuisance;
    /// Per chosen effect: log-odds against the model without it, if friction may build up over a short way
    /// after each reversal (`NuisanceParameters`).
    std::vector<double> margin_with_lags;
    /// Per output: no effect is exactly right, because the weights of the noise and equal weights give values
    /// that differ by more than noise (`make_robust`).
    std::vector<bool> inexact;

    /// Returns the contribution (T x m) of the `wanted` chosen effects to the outputs, by `fit`.
    Eigen::MatrixXd contribution_of(const DiagnosisSignals& signals,
                                    const std::function<bool(const Candidate&)>& wanted) const;
    /// Returns the contribution (T x m) of all effects and nuisance parameters, by `fit`.
    Eigen::MatrixXd total_contribution(const DiagnosisSignals& signals) const;
    /// Returns the contribution (T x m) of the named effects and nuisance parameters, by `values`.
    Eigen::MatrixXd reported_contribution(const DiagnosisSignals& signals) const;
    /// Coefficients of a chosen named candidate's shape, and their covariance, by `values`.
    Eigen::VectorXd coefficients(std::size_t chosen_index) const;
    Eigen::MatrixXd covariance(std::size_t chosen_index) const;
    /// Log-evidence of a chosen named candidate, by `values`.
    double evidence(std::size_t chosen_index) const;

    /// Returns the chosen effects that have a name, which are those of the fit `named`.
    std::vector<ChosenShape> named_effects() const;

    /// Returns the factor of a nuisance body or gain by `values`; 1 if the estimate is below 0.1.
    double nuisance_factor(Eigen::Index number) const;

    /// Index of the first column of a chosen candidate, in both fits.
    Eigen::Index first_column(std::size_t chosen_index) const;

  private:
    Eigen::MatrixXd of_fit(const DiagnosisSignals& signals, const EffectFit& of,
                           const std::function<bool(const Candidate&)>& wanted) const;
    Eigen::MatrixXd with_nuisance(const DiagnosisSignals& signals, const EffectFit& of,
                                  const std::function<bool(const Candidate&)>& wanted) const;
};

/// Searches all candidates for the model with the highest evidence, in rounds. Each round estimates the noise
/// from the current residual, makes the candidates that depend on the model again (delays, gains, drifts,
/// ripples, contacts) and refines shapes. The search ends when nothing changes. `measured`: T x m, in N·m (N)
/// also for currents. Cost: a round takes about the time of two fits of all columns; a second search follows
/// where an effect that yields (`Effect::yields`) was chosen in a round and not kept.
FittedEffects find_effects(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                           const FitOptions& options);

} // namespace dfdyn::tools
