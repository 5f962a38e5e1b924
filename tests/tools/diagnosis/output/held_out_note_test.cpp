// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/diagnosis_json.hpp"

#include "tests/support/catch.hpp"

#include <string>

TEST_CASE("a diagnosis calls its errors held out only if a part of the recording fitted nothing") {
    dfdyn::tools::Diagnosis diagnosis;
    const std::string claim = "these figures are on data that fitted nothing";
    CHECK(dfdyn::tools::diagnosis_json(diagnosis)["heldout"]["note"] != claim);
    diagnosis.heldout_from_s = 40;
    diagnosis.heldout_to_s = 60;
    CHECK(dfdyn::tools::diagnosis_json(diagnosis)["heldout"]["note"] == claim);
}
