// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tools/build_flags.hpp"

using Catch::Matchers::ContainsSubstring;

TEST_CASE("build flags name the version, the optimisation and the vectors, but no warning") {
    const std::string flags = dfdyn::tools::build_flags();
    CHECK_THAT(flags, ContainsSubstring("dfdyn 0."));
    CHECK_THAT(flags, ContainsSubstring(" -O"));
    CHECK_THAT(flags, ContainsSubstring("Eigen vectors: "));
    CHECK_THAT(flags, !ContainsSubstring("-W"));
    CHECK_THAT(flags, !ContainsSubstring("$<"));
#ifdef __AVX2__
    CHECK_THAT(flags, ContainsSubstring("-march="));
#endif
}
