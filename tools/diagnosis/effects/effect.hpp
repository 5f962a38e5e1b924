// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/signals/signals.hpp"

#include <cstdint>
#include <memory>
#include <vector>

namespace dfdyn::tools {

class EffectRegression;
class SpectralRows;
struct ChosenEffect;
struct ExplainingVariable;
struct Extension;
struct PlottedFinding;

/// How the extended model has an effect.
enum class EffectDisposition : std::uint8_t {
    adapting,     ///< coefficients that go on adapting
    fixed,        ///< a constant of the model: geometry, gravity, a gain
    approximated, ///< by the nearest effect that depends on the motion of one instant
    left_out,     ///< it has no form in the firmware
};

/// What an effect has a candidate for. Candidates are made in this order, and for each number in the order of
/// the catalogue.
enum class Each : std::uint8_t {
    sensor,       ///< the F/T sensor
    axis_pair,    ///< two axes of it: 6 from + to
    reading,      ///< every actuator, or the F/T sensor
    torque_joint, ///< every joint, where joint torques or motor currents were measured
    arm,          ///< the arm, once
    body,         ///< every link that the outputs depend on
    joint,        ///< every joint, whatever was measured
};

/// What a fitted model says: candidates that depend on it are made again after each fit.
struct FittedModel {
    Eigen::MatrixXd output;   ///< T x m: what a true sensor would show
    Eigen::MatrixXd friction; ///< T x n: the joints' friction (N·m); no columns for a wrench
    Eigen::VectorXd delay_s;  ///< m: the output's delay in this model
    bool gains_known = true;  ///< false: motor currents of unknown torque constants
};

/// What a fitted model leaves.
struct FittedResidual {
    const DiagnosisSignals& signals;
    const EffectRegression& regression;
    Eigen::VectorXd coefficients; ///< of all columns
    Eigen::VectorXd named;        ///< the same, zero for candidates without a name
    Eigen::MatrixXd weighed;      ///< T x m: weighed_residual() of `coefficients`
};

/// Looks for candidates whose time or shape only the residual shows.
class EffectScan {
  public:
    EffectScan() = default;
    EffectScan(const EffectScan&) = delete;
    EffectScan& operator=(const EffectScan&) = delete;
    virtual ~EffectScan() = default;

    /// The most promising ones. The scan must outlive them.
    virtual std::vector<Candidate> candidates(const FittedResidual& residual) const = 0;
    /// Sets the price of all candidates of this effect, found now or earlier.
    virtual void set_prices(const std::vector<Candidate*>& /*own*/,
                            const FittedResidual& /*residual*/) const {}
};

/// An effect of the catalogue: the only place that the diagnosis has it.
struct Effect {
    const char* name;  ///< as in diagnosis.json
    const char* where; ///< the places that it can be at: `jointK`, `tool`, …
    /// All that its candidates can have, the main one first.
    std::vector<ParameterKind> parameters;
    const char* remark = ""; ///< on the parameters, for the documentation
    /// What it does to the outputs: follows "the error of tau1 ".
    const char* evidence;
    /// The experiment that would settle whether it is there: follows "joint1: ".
    const char* experiment;
    const char* in_extended_model; ///< for the documentation

    bool friction = false;      ///< of a joint: friction_drift multiplies it
    bool beyond_arm = false;    ///< of the measurement, or from outside: no part of FittedModel::output
    bool delays_output = false; ///< its coefficient is the delay (s) of the outputs that it acts on
    bool mass_of_link = false;  ///< masses that are all a little off could explain it, too
    /// What the search has chosen stays a candidate beside what a scan of the residual finds.
    bool kept_while_chosen = false;
    /// Its parameters begin with start and end (s): findings at one place that overlap are the same.
    bool interval = false;
    double burst_evidence = 0; ///< log-odds that its findings lose, because real noise has such bursts

    Each each = Each::arm;
    /// Candidates at one place; null: none of this kind. `number`: of that which there is `each` of, from 0.
    std::vector<Candidate> (*candidates)(const DiagnosisSignals& signals, std::size_t number) = nullptr;
    /// The same, for candidates that depend on the fitted model.
    std::vector<Candidate> (*fitted_candidates)(const DiagnosisSignals& signals, const FittedModel& model,
                                                std::size_t number) = nullptr;
    std::unique_ptr<EffectScan> (*scan)(const DiagnosisSignals& signals, const SpectralRows& rows) = nullptr;

    /// The variable that a finding is plotted over; null: its own contribution.
    ExplainingVariable (*plotted_over)(const PlottedFinding& finding) = nullptr;
    /// Adds it to the extended model; null: left out.
    EffectDisposition (*extend)(Extension& extension, const ChosenEffect& chosen) = nullptr;
};

} // namespace dfdyn::tools
