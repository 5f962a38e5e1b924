// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/effect_regression.hpp"
#include "tools/diagnosis/search/explanation.hpp"

namespace dfdyn::tools {

/// What of an explanation stands once its search is at its end: whether masses are off, and of the chosen
/// effects those that predict blocks of time which did not fit them, and that a machine can have.
/// `regression`: of the explanation's problem. Makes its fit of the named effects alone. Cost: a search for
/// each time that something is dropped.
void settle(Explanation& at, const EffectRegression& regression);

} // namespace dfdyn::tools
