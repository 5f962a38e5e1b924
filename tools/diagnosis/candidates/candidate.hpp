// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// What one unit of a coefficient adds to the outputs: a series for each output that it acts on.
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
    double of_nothing = 0; ///< what it is where there is no such effect
    double unsettled = 0;  ///< share of the value, as a deviation, that no amount of data settles
};

/// A parameter of an effect, as the catalogue has it.
struct ParameterKind {
    const char* name;
    const char* unit;
    std::optional<double> null_value = 0; ///< what it is where there is no such effect; none: any value is
    double unsettled = 0;                 ///< as EffectParameter's

    EffectParameter at(double value) const {
        return {name, unit, value, null_value.value_or(value), unsettled};
    }
};

/// Whether a machine can have these coefficients.
using CoefficientRule = std::function<bool(const Eigen::VectorXd& coefficients)>;

using NearestCoefficients =
    std::function<Eigen::VectorXd(const Eigen::MatrixXd& squares, const Eigen::VectorXd& moments)>;

/// One way in which a candidate can act: some of its columns, and what their coefficients may be.
struct EffectShape {
    std::vector<std::size_t> columns; ///< of the candidate
    CoefficientRule allowed;
    double value = 0;   ///< the shape's own parameter, where the effect has one
    double bounded = 0; ///< how many of the coefficients can only be small where another one is
    /// Where the coefficients that explain most may not be: those that do among all that may, from the normal
    /// equations. Empty: none are looked for.
    NearestCoefficients nearest = {};
};

/// A named cause at a place: an effect of the catalogue; or, without a name, what an output would show if it
/// depended on some inputs. Its contribution is linear in the coefficients of one of its shapes.
struct Candidate {
    std::string effect, where;
    std::vector<std::string> inputs; ///< of a candidate without a name
    std::string detail;              ///< tells candidates of the same effect and place apart: axes, times
    std::string span;                ///< candidates of one span add the same columns in the end; empty: none
    std::string family;     ///< of several candidates of one family at most one is chosen; empty: none
    double tried = 1;       ///< of how many alternatives this one was picked beforehand
    double extra_price = 0; ///< what it must explain, in units of the evidence, because others of its kind do
    bool event = false;     ///< it happens at a time: no other time can tell of it
    std::vector<EffectColumn> columns;
    std::vector<EffectShape> shapes;
    /// The last column of a shape for another value of its parameter; empty where there is none, or only the
    /// listed ones make sense.
    std::function<EffectColumn(const EffectShape& shape, double value)> at_value;
    /// The same candidate made anew about what was found of it, the first shape of as many columns the one at
    /// hand: times closer to those found, a large angle's effect in the place of a small one's. Empty: it
    /// would be the same.
    std::function<Candidate(const EffectShape& shape, const Eigen::VectorXd& coefficients)> about;
    /// The catalogue's parameters, the main one first, from the coefficients of a shape.
    std::function<std::vector<EffectParameter>(const Eigen::VectorXd& coefficients, const EffectShape& shape)>
        parameters;

    bool named() const { return inputs.empty(); }
    std::string key() const { return effect + '@' + where + ' ' + detail; }
};

} // namespace dfdyn::tools
