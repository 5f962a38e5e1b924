// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Kind of a place with a number.
enum class PlaceKind : std::uint8_t { joint, actuator, encoder, link, output };

/// A place with a number: a part of the arm, or an output.
struct Place {
    PlaceKind kind = PlaceKind::joint;
    std::size_t index = 0; ///< from 0
};

/// Returns the name of a place, with its number from 1: `joint1`.
std::string place_text(PlaceKind kind, std::size_t index);

/// Returns the place with this name. Empty for places without a number: `base`, `tool`, `ft_sensor`.
std::optional<Place> numbered_place(const std::string& text);

/// Change of the outputs per unit of a coefficient: one series for each output on which it acts.
struct EffectColumn {
    struct Part {
        Eigen::Index output = 0;
        Eigen::VectorXd series; ///< T
    };
    std::vector<Part> parts;
};

struct EffectParameter {
    std::string name, unit;
    double value = 0;
    double null_value = 0;              ///< value when the effect is absent
    double systematic_relative_std = 0; ///< irreducible relative standard deviation (model error)
};

/// A parameter of an effect, as in the catalogue.
struct ParameterKind {
    const char* name;
    const char* unit;
    std::optional<double> null_value = 0; ///< value when the effect is absent; empty: no such value exists
    double systematic_relative_std = 0;   ///< as in EffectParameter

    EffectParameter at(double value) const {
        return {name, unit, value, null_value.value_or(value), systematic_relative_std};
    }
};

/// Returns whether coefficients are physically possible.
using CoefficientRule = std::function<bool(const Eigen::VectorXd& coefficients)>;

using NearestCoefficients =
    std::function<Eigen::VectorXd(const Eigen::MatrixXd& squares, const Eigen::VectorXd& moments)>;

/// One shape of a candidate: a subset of its columns, and the admissible values of their coefficients.
struct EffectShape {
    std::vector<std::size_t> columns; ///< of the candidate
    CoefficientRule allowed;
    double value = 0;         ///< the shape's own parameter, if the effect has one
    double bounded_count = 0; ///< number of coefficients that another coefficient bounds
    /// Returns the admissible coefficients that explain most, from the normal equations, if the unconstrained
    /// ones are not admissible. Empty: the shape has no such search.
    NearestCoefficients nearest = {};
    /// number of columns that the shape lacks because the motion does not determine them
    std::size_t undetermined = 0;
};

/// A candidate cause at a place. It is either an effect of the catalogue, or an unnamed dependence of an
/// output on some inputs. Its contribution is linear in the coefficients of one of its shapes.
struct Candidate {
    std::string effect, where;
    std::vector<std::string> inputs; ///< inputs of an unnamed candidate
    std::string detail;              ///< distinguishes candidates of the same effect and place: axes, times
    std::string span;   ///< candidates with the same span describe the same set of columns; empty: none
    std::string family; ///< at most one candidate of a family is chosen; empty: no family
    /// Multiplies the number of its shapes in the prior: the number of alternatives from which it was
    /// selected beforehand. For links and payloads it contains the number of shapes that exist over those
    /// that the motion determines, so that missing ones do not change the prior of the others.
    double prior_trials = 1;
    /// minimum log-evidence that it must exceed, from the other candidates of its kind
    double evidence_offset = 0;
    bool event = false; ///< occurs once: other times carry no information on it
    std::vector<EffectColumn> columns;
    std::vector<EffectShape> shapes;
    /// Returns the last column of a shape for another value of its parameter. Empty: the effect has no
    /// parameter, or only the listed values are possible.
    std::function<EffectColumn(const EffectShape& shape, double value)> at_value;
    /// Returns the candidate relinearized about its estimate. Its first shape with the same number of columns
    /// is the current one: with nearer times, or with the exact effect of a large angle or a displaced mass.
    /// Empty: relinearization would change nothing.
    std::function<Candidate(const EffectShape& shape, const Eigen::VectorXd& coefficients)> relinearized_at;
    /// Returns the catalogue's parameters, the main one first, from the coefficients of a shape.
    std::function<std::vector<EffectParameter>(const Eigen::VectorXd& coefficients, const EffectShape& shape)>
        parameters;
    /// It has a family and is relinearized even while it is not chosen, about the estimate of its last shape.
    /// Otherwise a sum of other effects may come nearer to its true effect than its own columns about zero.
    bool always_relinearized = false;

    bool named() const { return inputs.empty(); }
    std::string key() const { return effect + '@' + where + ' ' + detail; }
};

} // namespace dfdyn::tools
