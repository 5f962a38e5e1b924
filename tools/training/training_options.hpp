// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/train.hpp"

#include <string>

namespace dfdyn::tools {

/// Returns NP, P, SP, SP2 or SPK.
std::string to_string(ModelClass model);

/// Return the value with this name (`scaled`, `unit` or `diagonal`; ML or CV). Throw InputError for any other
/// name.
ModelClass parse_model_class(const std::string& name);
PriorForm parse_prior_form(const std::string& name);
HyperMethod parse_hyper_method(const std::string& name);

/// Throws InputError with the option's name unless all options are in range and consistent with each other
/// and with `data`.
void check_options(const TrainingOptions& options, const TrainingData& data);

} // namespace dfdyn::tools
