// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/support/name_literals.hpp"
#include "tools/simulation/faults/fault_kind.hpp"

#include <set>
#include <string>

namespace fault_names_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

TEST_CASE("the name of a simulated fault is a literal only in its own file") {
    std::set<std::string> kinds;
    for (const FaultKind& kind : fault_catalogue()) {
        kinds.emplace(kind.name);
    }
    const std::set<std::string> other_meanings{
        "tools/diagnosis/effects/actuator_gain.cpp", // an effect
        "hal/include/dfdyn/hal/reason.hpp",          // reasons of the bus layer
        "tools/can/check/value_rules.cpp",
        "tools/can/motors/motor_board.cpp",
    };
    std::set<std::string> seen;
    for (const auto& [file, names] : files_with_names(kinds)) {
        for (const std::string& name : names) {
            CAPTURE(file, name);
            const bool own = file == "tools/simulation/faults/" + name + ".cpp";
            CHECK((own || other_meanings.contains(file)));
            seen.insert(own ? name : "");
        }
    }
    seen.erase("");
    CHECK(seen == kinds);
}

} // namespace fault_names_test
