// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/train.hpp"

#include <string>

namespace dfdyn::tools {

/// NP, P, SP, SP2 or SPK.
std::string to_string(ModelClass model);

/// What has that name (`scaled`, `unit` or `diagonal`; ML or CV); throw InputError for any other.
ModelClass parse_model_class(const std::string& name);
PriorForm parse_prior_form(const std::string& name);
HyperMethod parse_hyper_method(const std::string& name);

/// Throws InputError that names the option unless all are in range and go together with each other and with
/// `data`.
void check_options(const TrainingOptions& options, const TrainingData& data);

} // namespace dfdyn::tools
