// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/support/name_literals.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/model/structure.hpp"

#include <cctype>
#include <map>
#include <set>
#include <string>

namespace catalogue_names_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

std::string lower_case(std::string text) {
    for (char& character : text) {
        character = static_cast<char>(std::tolower(static_cast<unsigned char>(character)));
    }
    return text;
}

TEST_CASE("the name of an input is a literal only in its own file") {
    std::set<std::string> inputs;
    for (const InputDescription* const input : input_catalogue()) {
        inputs.insert(input->name);
    }
    std::map<std::string, std::set<std::string>> expected;
    for (const std::string& name : inputs) {
        expected["tools/model/inputs/" + lower_case(name) + ".cpp"] = {name};
    }
    CHECK(files_with_names(inputs) == expected);
}

TEST_CASE("the name of a structure is a literal only in the catalogue of structures") {
    std::set<std::string> names;
    for (const Structure* const one : all_structures()) {
        names.insert(one->name);
    }
    const std::map<std::string, std::set<std::string>> expected{
        {"tools/model/structure.hpp", names},
        {"tools/model/model.hpp", {TrainedModel{}.structure}}, // the default of a model
    };
    CHECK(files_with_names(names) == expected);
}

} // namespace catalogue_names_test
