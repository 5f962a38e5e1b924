// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace dfdyn::tools {

/// What an effect of the catalogue does to the outputs, in words that follow "the error ".
std::string effect_signature(const std::string& effect);

/// The experiment that would settle whether it is there.
std::string confirming_experiment(const std::string& effect, const std::string& where);

} // namespace dfdyn::tools
