// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/model_training.hpp"

#include <string>

namespace dfdyn::tools {

/// Prints the result of `dfdyn train` on stdout, for a model trained on the recordings named `trained_on`.
void print_outcome(const ModelTrainingResult& result, const std::string& trained_on);

} // namespace dfdyn::tools
