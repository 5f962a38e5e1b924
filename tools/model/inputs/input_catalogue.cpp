// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/model/inputs/input_description.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

namespace dfdyn::tools {

std::span<const InputDescription* const> input_catalogue() {
    static const std::array<const InputDescription*, 5> all{&std_input(), &df_input(), &dfw_input(),
                                                            &dfr_input(), &dfsr_input()};
    return all;
}

const InputDescription& input_description(InputKind kind) {
    const auto all = input_catalogue();
    const auto found =
        std::ranges::find_if(all, [kind](const InputDescription* input) { return input->kind == kind; });
    if (found == all.end()) {
        throw std::logic_error("an input that is not in the catalogue");
    }
    return **found;
}

std::string input_names(const char* separator) {
    std::string names;
    for (const InputDescription* const input : input_catalogue()) {
        names.append(names.empty() ? "" : separator).append(input->name);
    }
    return names;
}

InputKind parse_input_kind(const std::string& name) {
    for (const InputDescription* const input : input_catalogue()) {
        if (input->name == name) {
            return input->kind;
        }
    }
    throw InputError("input: expected one of " + input_names(", ") + ", found " + in_quotes(name));
}

} // namespace dfdyn::tools
