// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

namespace dfdyn::tools {

/// The signed-rank test of Wilcoxon, one-sided and exact.
struct SignedRankTest {
    double positive_rank_sum = 0; ///< W+: the ranks of |d| where d > 0, ties sharing their mean rank
    int count = 0;                ///< of the differences that are not 0; the others do not count
    double p_negative = 1;        ///< probability of a sum this small or smaller if d were symmetric about 0
    double p_positive = 1;        ///< … this large or larger
};

/// Tests whether `differences` (finite) lie rather below or above 0. Exact for any number of them, ties
/// included, from the distribution over all choices of signs: O(n³).
SignedRankTest signed_rank_test(std::span<const double> differences);

} // namespace dfdyn::tools
