// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

// Parts of the generated C++ headers.

/// Returns a float literal that compiles to exactly `value` in single precision.
std::string literal(double value);

/// Returns `{{1.0F, 2.0F}}`, with line breaks.
std::string braced(std::span<const double> values);
std::string integers(std::span<const int> values);

std::string joined(std::span<const std::string> texts, const char* separator);

/// Returns `dfdyn::name<a, b>`.
std::string type(const std::string& name, const std::vector<std::string>& arguments);

/// The type of an input map, and its constants.
std::string input_type(const InputModel& input);
std::string input_constants(const InputModel& input);

} // namespace dfdyn::tools
