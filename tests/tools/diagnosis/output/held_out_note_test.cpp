// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/diagnosis_json.hpp"

#include "tests/support/catch.hpp"

#include <string>

TEST_CASE("a diagnosis reports held-out errors only if part of the recording was not used for fitting") {
    dfdyn::tools::Diagnosis diagnosis;
    const std::string claim = "errors on data that were not used for fitting";
    CHECK(dfdyn::tools::diagnosis_json(diagnosis)["heldout"]["note"] != claim);
    diagnosis.heldout_from_s = 40;
    diagnosis.heldout_to_s = 60;
    CHECK(dfdyn::tools::diagnosis_json(diagnosis)["heldout"]["note"] == claim);
}
