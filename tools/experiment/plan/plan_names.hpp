// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/json_reader.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace dfdyn::tools {

/// Largest number of entries of a list in a plan.
inline constexpr int most_entries = 10000;

/// In a comparison: all cases without a suffix, those of the paper.
inline constexpr std::string_view set_of_the_paper = "paper";

/// Reads a text that can be part of a file's name: letters, digits, '-' and '_'.
std::string plain_name(const JsonReader& reader, const std::string& name);

/// Reads a text or a list of texts.
std::vector<std::string> names_in(const JsonReader& reader, const std::string& name);

/// Throws InputError about `field` if the last entry of `list` has the name of another one.
template <class Named>
void refuse_twice(const JsonReader& reader, const std::string& field, const std::vector<Named>& list) {
    const std::string& name = list.back().name;
    if (std::ranges::count(list, name, &Named::name) > 1) {
        throw reader.error(field, "names that are there once", in_quotes(name) + " twice");
    }
}

/// Returns `name`. Throws InputError about `field` if no entry of `list` has this name.
template <class Named>
const std::string& known(const JsonReader& reader, const std::string& field, const std::vector<Named>& list,
                         const std::string& name) {
    if (std::ranges::count(list, name, &Named::name) == 0) {
        std::vector<std::string> names;
        std::ranges::transform(list, std::back_inserter(names), &Named::name);
        throw reader.error(field, "one of " + listed(names), in_quotes(name));
    }
    return name;
}

} // namespace dfdyn::tools
