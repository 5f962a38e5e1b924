// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace dfdyn::tools {

/// Wilcoxon's signed-rank test, one-sided and exact.
struct SignedRankTest {
    double positive_rank_sum = 0; ///< W+: sum of the ranks of |d| with d > 0; ties have their mean rank
    int count = 0;                ///< number of differences other than 0; the others are ignored
    double p_negative = 1;        ///< probability of a sum this small or smaller for d symmetric about 0
    double p_positive = 1;        ///< … this large or larger
};

/// Tests whether `differences` (finite) are below or above 0. Exact for any number of them, including ties,
/// from the distribution over all combinations of signs: O(n³).
SignedRankTest signed_rank_test(std::span<const double> differences);

} // namespace dfdyn::tools
