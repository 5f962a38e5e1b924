// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/result/wilcoxon.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <cmath>
#include <vector>

namespace wilcoxon_test {

namespace tools = dfdyn::tools;

/// The numbers 1 to n, which are their own ranks. Those that sum to `positive_sum` are positive, largest
/// first.
std::vector<double> differences_with(int n, int positive_sum) {
    std::vector<double> differences;
    for (int rank = n; rank >= 1; --rank) {
        const bool positive = rank <= positive_sum;
        differences.push_back(positive ? rank : -rank);
        positive_sum -= positive ? rank : 0;
    }
    REQUIRE(positive_sum == 0);
    return differences;
}

/// The mean rank of |d|: one plus the number below it plus half the number of others that equal it.
double rank_of(double difference, const std::vector<double>& all) {
    double rank = 0.5;
    for (const double other : all) {
        rank += std::abs(other) < std::abs(difference) ? 1 : 0;
        rank += std::abs(other) == std::abs(difference) ? 0.5 : 0;
    }
    return rank;
}

struct Enumerated {
    double sum, p_negative, p_positive;
};

/// Enumerates every choice of signs.
Enumerated enumerate(const std::vector<double>& differences) {
    std::vector<double> ranks;
    double observed = 0;
    for (const double difference : differences) {
        ranks.push_back(rank_of(difference, differences));
        observed += difference > 0 ? ranks.back() : 0;
    }
    const std::size_t choices = std::size_t{1} << ranks.size();
    std::size_t below = 0;
    std::size_t above = 0;
    for (std::size_t choice = 0; choice < choices; ++choice) {
        double sum = 0;
        for (std::size_t i = 0; i < ranks.size(); ++i) {
            sum += (choice >> i & 1U) != 0 ? ranks[i] : 0;
        }
        below += sum <= observed ? 1 : 0;
        above += sum >= observed ? 1 : 0;
    }
    return {observed, static_cast<double>(below) / static_cast<double>(choices),
            static_cast<double>(above) / static_cast<double>(choices)};
}

TEST_CASE("the signed-rank test has the probabilities of the published tables") {
    // n, sum, one-sided probability of that sum or less
    const auto [n, sum, probability] = GENERATE(table<int, int, double>({{5, 0, 0.0313},
                                                                         {6, 2, 0.0469},
                                                                         {8, 5, 0.0391},
                                                                         {10, 8, 0.0244},
                                                                         {10, 10, 0.0420},
                                                                         {10, 11, 0.0527},
                                                                         {15, 30, 0.0473},
                                                                         {20, 60, 0.0487}}));
    CAPTURE(n, sum);
    const tools::SignedRankTest test = tools::signed_rank_test(differences_with(n, sum));
    CHECK(test.count == n);
    CHECK(test.positive_rank_sum == sum);
    CHECK(test.p_negative == Approx(probability).margin(6e-5));
}

TEST_CASE("the signed-rank test equals the enumeration of all signs including ties") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_int_distribution<int> coarse(-4, 4);
    for (int trial = 0; trial < 60; ++trial) {
        std::vector<double> differences;
        const int count = 1 + trial % 11;
        while (static_cast<int>(differences.size()) < count) {
            if (const int value = coarse(engine); value != 0) {
                differences.push_back(value);
            }
        }
        const Enumerated expected = enumerate(differences);
        const tools::SignedRankTest test = tools::signed_rank_test(differences);
        CHECK(test.positive_rank_sum == expected.sum);
        CHECK(test.p_negative == Approx(expected.p_negative).epsilon(1e-12));
        CHECK(test.p_positive == Approx(expected.p_positive).epsilon(1e-12));
    }
}

TEST_CASE("differences of zero are ignored") {
    const std::vector<double> with_zeros{0, -1, 0, -2, 3, 0};
    const tools::SignedRankTest test = tools::signed_rank_test(with_zeros);
    CHECK(test.count == 3);
    CHECK(test.p_negative == tools::signed_rank_test(std::vector<double>{-1, -2, 3}).p_negative);
    const tools::SignedRankTest none = tools::signed_rank_test(std::vector<double>{0, 0});
    CHECK(none.p_negative == 1);
    CHECK(none.p_positive == 1);
}

} // namespace wilcoxon_test
