// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/signals/signals.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace dfdyn::tools {

class EffectRegression;
class SpectralRows;
struct ChosenEffect;
struct PlotAbscissa;
struct ModelExtension;
struct PlottedFinding;

/// Representation of an effect in the extended model.
enum class EffectDisposition : std::uint8_t {
    adapting,     ///< coefficients that continue to adapt
    fixed,        ///< a constant of the model: geometry, gravity, a gain
    approximated, ///< replaced by the nearest effect that depends on the current motion only
    left_out,     ///< the firmware has no representation of it
};

/// The set of places for which an effect has one candidate each. Candidates are made in this order, and for
/// each place in the order of the catalogue.
enum class Each : std::uint8_t {
    sensor,       ///< the F/T sensor
    axis_pair,    ///< an ordered pair of sensor axes: 6 from + to
    reading,      ///< every actuator, or the F/T sensor
    torque_joint, ///< every joint, where joint torques or motor currents were measured
    arm,          ///< the arm, once
    body,         ///< every link on which the outputs depend
    joint,        ///< every joint, regardless of the measured quantity
};

/// Terms of plain least squares of one output, in the order of its coefficients (`textbook_fit`).
enum class TextbookTerm : std::uint8_t { gain, inertia, viscous, dry, offset };

/// Quantities of a fitted model. Candidates that depend on them are made again after each fit.
struct FittedModel {
    Eigen::MatrixXd output;    ///< T x m: outputs that an ideal sensor would measure
    Eigen::MatrixXd friction;  ///< T x n: the joints' friction (N·m); no columns for a wrench
    Eigen::VectorXd delay_s;   ///< m: the output's delay in this model
    bool gains_may_err = true; ///< false: given gains are not doubted yet, or are unknown torque constants
    /// roll, pitch and yaw (rad) of the F/T sensor in this model
    Eigen::Vector3d sensor_angles = Eigen::Vector3d::Zero();
};

/// Residual of a fitted model, with its coefficients.
struct FittedResidual {
    const DiagnosisSignals& signals;
    const EffectRegression& regression;
    Eigen::VectorXd coefficients; ///< of all columns
    Eigen::VectorXd named;        ///< the same, with zeros for unnamed candidates
    Eigen::MatrixXd weighted;     ///< T x m: weighted_residual() of `coefficients`
};

/// Finds candidates whose time or shape only the residual shows.
class EffectScan {
  public:
    EffectScan() = default;
    EffectScan(const EffectScan&) = delete;
    EffectScan& operator=(const EffectScan&) = delete;
    virtual ~EffectScan() = default;

    /// Returns the candidates that explain most of the residual. The scan must outlive them.
    virtual std::vector<Candidate> candidates(const FittedResidual& residual) const = 0;
    /// Sets the evidence offset (`evidence_offset`) of all candidates of this effect, found now or earlier.
    virtual void set_evidence_offsets(const std::vector<Candidate*>& /*own*/,
                                      const FittedResidual& /*residual*/) const {}
};

/// An effect of the catalogue. The diagnosis defines it here and nowhere else.
struct Effect {
    const char* name;  ///< as in diagnosis.json
    const char* where; ///< the places where it can act: `jointK`, `tool`, …
    /// All parameters that its candidates can have, the main one first.
    std::vector<ParameterKind> parameters;
    const char* remark = ""; ///< remark on the parameters, for the documentation
    /// Its influence on the outputs. The text follows "the error of tau1 ".
    const char* evidence;
    /// The experiment that would decide whether it is present. The text follows "joint1: ".
    const char* experiment;
    const char* in_extended_model; ///< for the documentation

    bool friction = false;      ///< joint friction, which friction_drift multiplies
    bool beyond_arm = false;    ///< acts on the measurement or from outside: not part of FittedModel::output
    bool delays_output = false; ///< its coefficient is the delay (s) of its outputs
    bool turns_sensor = false;  ///< its columns' coefficients are the sensor's roll, pitch and yaw (rad)
    bool mass_of_link = false;  ///< small errors of all links' masses could explain it as well
    /// A chosen candidate is kept even when a later scan of the residual does not find it again.
    bool kept_while_chosen = false;
    /// Its columns resemble a combination of other effects'. If a round of the search chooses one of its
    /// `candidates` and the search does not keep it, the result is that of a search without them.
    bool yields = false;
    /// Its parameters begin with start and end (s). Overlapping findings at one place are the same finding.
    bool interval = false;
    /// log-odds subtracted from its findings, because real noise has similar bursts
    double burst_evidence = 0;

    /// The term of plain least squares that is its main parameter; empty: none is.
    std::optional<TextbookTerm> textbook = {};

    Each each = Each::arm;
    /// Returns the candidates at one place. Null: the effect has none of this kind. `number`: index of the
    /// place (kind `each`), from 0.
    std::vector<Candidate> (*candidates)(const DiagnosisSignals& signals, std::size_t number) = nullptr;
    /// Returns the candidates that depend on the fitted model.
    std::vector<Candidate> (*fitted_candidates)(const DiagnosisSignals& signals, const FittedModel& model,
                                                std::size_t number) = nullptr;
    std::unique_ptr<EffectScan> (*scan)(const DiagnosisSignals& signals, const SpectralRows& rows) = nullptr;

    /// Returns the variable over which a finding is plotted. Null: the finding's own contribution.
    PlotAbscissa (*plotted_over)(const PlottedFinding& finding) = nullptr;
    /// Adds the effect to the extended model. Null: it is left out.
    EffectDisposition (*extend)(ModelExtension& extension, const ChosenEffect& chosen) = nullptr;
};

} // namespace dfdyn::tools
