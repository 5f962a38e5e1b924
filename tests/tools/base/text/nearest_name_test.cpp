// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/nearest_name.hpp"

#include "tests/support/catch.hpp"

#include <string>
#include <vector>

using dfdyn::tools::nearest_name;
using dfdyn::tools::suggestion;

TEST_CASE("the nearest name is found after one or two slips and not beyond a third of the letters") {
    const std::vector<std::string> known{"train", "replay", "diagnose", "t", "q1", "--columns"};
    const auto [name, nearest] = GENERATE(table<std::string, std::string>({
        {"trian", "train"},        // exchanged
        {"trai", "train"},         // missing
        {"rreplay", "replay"},     // too many
        {"Replay", "replay"},      // case
        {"diagnoze", "diagnose"},  // changed
        {"dagnoes", "diagnose"},   // missing and exchanged
        {"--colums", "--columns"}, //
        {"T", "t"},                //
        {"Q1", "q1"},              //
    }));
    CHECK(nearest_name(name, known) == nearest);
    for (const std::string far : {"x", "q2", "fly", "play", "tau1", "", "diagram"}) {
        CAPTURE(far);
        CHECK_FALSE(nearest_name(far, known));
    }
    CHECK_FALSE(nearest_name(std::string(1000, 'a'), known));
}

TEST_CASE("a suggestion is a question at the end of a message, or nothing") {
    const std::vector<std::string> known{"train"};
    CHECK(suggestion("trian", known) == " (did you mean \"train\"?)");
    CHECK(suggestion("fly", known).empty());
}
