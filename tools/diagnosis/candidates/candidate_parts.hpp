// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/signals/signals.hpp"

#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

/// Returns `size`, or a minimum step if it is smaller. Dividing an effect by this step yields its slope.
inline double at_least_small(double size) {
    constexpr double small = 1e-4;
    return std::abs(size) > small ? size : std::copysign(small, size);
}

inline EffectColumn on_output(Eigen::Index output, Eigen::VectorXd series) {
    EffectColumn column;
    column.parts.push_back({output, std::move(series)});
    return column;
}

inline EffectColumn on_outputs(const Eigen::MatrixXd& series) {
    EffectColumn column;
    for (Eigen::Index output = 0; output < series.cols(); ++output) {
        column.parts.push_back({output, series.col(output)});
    }
    return column;
}

/// Accepts coefficients from zero to `largest`. The second rule accepts both signs up to it.
inline CoefficientRule positive_up_to(double largest) {
    return [largest](const Eigen::VectorXd& coefficients) {
        return (coefficients.array() > 0).all() && coefficients.maxCoeff() <= largest;
    };
}
inline CoefficientRule up_to(double largest) {
    return [largest](const Eigen::VectorXd& coefficients) { return coefficients.norm() <= largest; };
}
/// Accepts positive coefficients without a limit. The second rule accepts any number.
inline bool is_positive(const Eigen::VectorXd& coefficients) { return (coefficients.array() > 0).all(); }
inline bool is_anything(const Eigen::VectorXd& /*coefficients*/) { return true; }
/// Requires the first coefficient to be positive; the others are free.
inline bool first_is_positive(const Eigen::VectorXd& coefficients) { return coefficients[0] > 0; }

/// Returns the shape with all columns of the candidate.
inline EffectShape whole_shape(const Candidate& candidate, CoefficientRule allowed) {
    EffectShape shape;
    shape.columns.resize(candidate.columns.size());
    std::iota(shape.columns.begin(), shape.columns.end(), std::size_t{0});
    shape.allowed = std::move(allowed);
    return shape;
}

/// Returns a candidate with one column and without parameters.
inline Candidate single_column(std::string where, EffectColumn column, CoefficientRule allowed) {
    Candidate candidate;
    candidate.where = std::move(where);
    candidate.columns.push_back(std::move(column));
    candidate.shapes.push_back(whole_shape(candidate, std::move(allowed)));
    return candidate;
}

/// Returns a candidate with one column, with the coefficient as its parameter.
inline Candidate single_column(std::string where, EffectColumn column, CoefficientRule allowed,
                               const ParameterKind& parameter) {
    Candidate candidate = single_column(std::move(where), std::move(column), std::move(allowed));
    candidate.parameters = [parameter](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector<EffectParameter>{parameter.at(coefficients[0])};
    };
    return candidate;
}

} // namespace dfdyn::tools
