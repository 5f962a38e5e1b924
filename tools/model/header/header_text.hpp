// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/dynamic_storage.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

// Parts of the generated C++ headers.

/// Returns a float literal that compiles to exactly `value`.
std::string literal(float value);

/// Returns `{1.0F, 2.0F}`, with line breaks.
std::string array(std::span<const float> values);

/// Returns `{{1.0F, 2.0F}}`, the initializer of a Storage.
template <int count>
std::string literal(const Storage<float, count>& values) {
    return "{" + array({values.data(), static_cast<std::size_t>(values.size())}) + "}";
}
std::string literal(const Storage<std::int32_t, dynamic>& values);

std::string joined(std::span<const std::string> texts, const char* separator);

/// Returns `dfdyn::name<a, b>`.
std::string type(const std::string& name, const std::vector<std::string>& arguments);

} // namespace dfdyn::tools
