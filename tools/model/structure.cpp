// SPDX-License-Identifier: Apache-2.0
#include "tools/model/structure.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <array>

namespace dfdyn::tools {

std::span<const Structure* const> all_structures() {
    static constexpr std::array<const Structure*, 5> all{&structures::NP, &structures::P, &structures::SP,
                                                         &structures::SP2, &structures::SPK};
    return all;
}

const Structure* find_structure(const std::string& name) {
    const auto all = all_structures();
    const auto found =
        std::ranges::find_if(all, [&name](const Structure* structure) { return structure->name == name; });
    return found == all.end() ? nullptr : *found;
}

const Structure& structure(const std::string& name) {
    const Structure* const found = find_structure(name);
    if (found == nullptr) {
        throw InputError("model: expected one of " + listed(structure_names()) + ", found " +
                         in_quotes(name));
    }
    return *found;
}

const Structure& structure_of(const TrainedModel& model) { return structure(model.structure); }

std::vector<std::string> structure_names() {
    std::vector<std::string> names;
    for (const Structure* const structure : all_structures()) {
        names.emplace_back(structure->name);
    }
    return names;
}

} // namespace dfdyn::tools
