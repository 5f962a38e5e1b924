// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace dfdyn::tools {

/// Returns the name of `known` that `name` is probably a misspelling of; nothing if none is close. Upper and
/// lower case count as equal. At most a third of the letters may be inserted, removed, changed or exchanged
/// with their neighbour (optimal string alignment distance). Of equally close names the first is returned.
/// O(length² × names); names beyond 100 letters are not compared.
std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> known);

/// Returns ` (did you mean "NEAREST"?)`, or nothing, to append to an error message.
std::string suggestion(std::string_view name, std::span<const std::string> known);

} // namespace dfdyn::tools
