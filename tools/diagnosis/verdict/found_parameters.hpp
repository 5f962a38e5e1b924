// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

inline constexpr double deviations_of_95 = 1.96; ///< on either side

/// The parameters of a chosen candidate with a name, with intervals that have what other shapes of it that
/// are nearly as likely would say.
std::vector<FoundParameter> found_parameters(const Explanation& explanation, std::size_t chosen_index);

/// Half the width of a parameter's 95 % interval: its standard deviation by the regression, were the noise
/// just as weighed, and how far it is from the value that means nothing.
double reach_of_95(double deviation, double effect);

/// The standard deviation that a 95 % interval stands for.
double deviation_of(const FoundParameter& parameter);

} // namespace dfdyn::tools
