// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/train.hpp"

#include <string>

namespace dfdyn::tools {

/// NP, P, SP, SP2 or SPK.
std::string to_string(ModelClass model);

/// Throws InputError that names the option unless all are in range and go together with each other and with
/// `data`.
void check_options(const TrainingOptions& options, const TrainingData& data);

} // namespace dfdyn::tools
