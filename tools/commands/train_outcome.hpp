// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sizing/target.hpp"
#include "tools/training/model_training.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace dfdyn::tools {

/// Prints the result of `dfdyn train` on stdout, for a model trained on the recordings named `trained_on`.
void print_outcome(const ModelTrainingResult& result, const std::string& trained_on);

/// Returns the figures of a training with those of `footprint` on `target`, schema `dfdyn.training/1`.
nlohmann::ordered_json outcome_json(const ModelTrainingResult& result, const Target& target);

} // namespace dfdyn::tools
