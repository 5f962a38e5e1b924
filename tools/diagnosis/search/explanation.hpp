// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/candidates/effect_regression.hpp"
#include "tools/diagnosis/search/effect_search.hpp"
#include "tools/diagnosis/signals/signals.hpp"

#include <functional>
#include <vector>

namespace dfdyn::tools {

struct ExplanationOptions {
    bool gains_known = true; ///< false: every joint has a factor of its own, which is no finding
    double fitted_share = 1; ///< of the recording's time, from its beginning; the rest may only be predicted
    std::function<void(int round)> progress = {};
};

/// What explains the difference between a measurement and the rigid body.
struct Explanation {
    std::vector<Candidate> candidates;
    std::vector<ChosenShape> chosen; ///< of `candidates`, those with a name first
    SearchProblem problem;
    EffectFit fit;   ///< of all of them
    EffectFit named; ///< of those with a name alone: nothing unnamed may bend their coefficients
    Eigen::Index uncertain_masses =
        0;                 ///< links that are a little off, the first of the nuisance: all or none
    Eigen::MatrixXd noise; ///< bins x m: spectra of what is left
    std::vector<EffectColumn> nuisance;

    /// T x m: what those of the chosen effects that are `wanted` add to the rigid body's outputs, by `fit`.
    Eigen::MatrixXd effects(const DiagnosisSignals& signals,
                            const std::function<bool(const Candidate&)>& wanted) const;
    /// T x m: all effects and the nuisance, by `fit`.
    Eigen::MatrixXd all(const DiagnosisSignals& signals) const;
    /// T x m: the named effects and the nuisance, by `named`.
    Eigen::MatrixXd model(const DiagnosisSignals& signals) const;
    /// The coefficients of a chosen candidate's shape with a name, and their covariance, by `named`.
    Eigen::VectorXd coefficients(std::size_t chosen_index) const;
    Eigen::MatrixXd covariance(std::size_t chosen_index) const;

    /// Those of the chosen that have a name: `named` is their fit.
    std::vector<ChosenShape> named_effects() const;

    /// By `fit`, what one of the nuisance's bodies or gains is multiplied by; 1 where that would be none.
    double nuisance_factor(Eigen::Index number) const;

    /// Of both fits: where a chosen candidate's columns begin.
    Eigen::Index first_column(std::size_t chosen_index) const;

  private:
    Eigen::MatrixXd of_fit(const DiagnosisSignals& signals, const EffectFit& of,
                           const std::function<bool(const Candidate&)>& wanted) const;
    Eigen::MatrixXd with_nuisance(const DiagnosisSignals& signals, const EffectFit& of,
                                  const std::function<bool(const Candidate&)>& wanted) const;
};

/// Searches among all candidates at once, in rounds: the noise is what the model at hand leaves, candidates
/// that depend on the model (delays, gains, drifts, ripples, contacts) are made anew, shapes are refined,
/// until nothing changes. `measured`: T x m, in N·m (N) also for currents.
Explanation explain(const DiagnosisSignals& signals, const Eigen::MatrixXd& measured,
                    const ExplanationOptions& options);

} // namespace dfdyn::tools
