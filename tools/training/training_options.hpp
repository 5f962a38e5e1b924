// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/train.hpp"

#include <string>

namespace dfdyn::tools {

/// Return the value with this name (`scaled`, `unit` or `diagonal`; ML or CV). Throw InputError for any other
/// name.
PriorForm parse_prior_form(const std::string& name);
HyperMethod parse_hyper_method(const std::string& name);

/// Throws InputError with the option's name unless all options are in range and consistent with each other
/// and with `data`.
void check_options(const TrainingOptions& options, const TrainingData& data);

} // namespace dfdyn::tools
