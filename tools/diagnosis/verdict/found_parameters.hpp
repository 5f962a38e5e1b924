// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

inline constexpr double deviations_of_95 = 1.96; ///< on either side

/// Returns the parameters of a chosen named candidate. Their intervals include other shapes with almost the
/// same evidence.
std::vector<FoundParameter> found_parameters(const FittedEffects& fitted_effects, std::size_t chosen_index);

/// Returns half the width of a parameter's 95 % interval. `deviation`: its standard deviation in the
/// regression, for noise with the assumed weights; `effect`: difference from its null value.
double reach_of_95(double deviation, double effect);

/// Returns a parameter with its 95 % interval, from its standard deviation.
FoundParameter parameter_within(std::string name, std::string unit, double value, double deviation);

/// Returns a parameter that is certainly positive, with the 95 % interval of a normal distribution without
/// its negative part.
FoundParameter positive_parameter(std::string name, std::string unit, double value, double deviation);

/// Standard deviation that corresponds to a 95 % interval.
double deviation_of(const FoundParameter& parameter);

} // namespace dfdyn::tools
