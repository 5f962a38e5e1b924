// SPDX-License-Identifier: Apache-2.0
#include "tools/experiment/result/wilcoxon.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace dfdyn::tools {

namespace {

/// Returns twice the ranks, so that the mean ranks of ties are integers.
std::vector<std::size_t> doubled_ranks(const std::vector<double>& ascending_magnitudes) {
    std::vector<std::size_t> ranks;
    for (const double magnitude : ascending_magnitudes) {
        const auto [first, last] =
            std::equal_range(ascending_magnitudes.begin(), ascending_magnitudes.end(), magnitude);
        const auto below = static_cast<std::size_t>(first - ascending_magnitudes.begin());
        const auto tied = static_cast<std::size_t>(last - first);
        ranks.push_back(2 * below + tied + 1);
    }
    return ranks;
}

/// Returns the probability of each sum of the positive ranks, if all combinations of signs are equally
/// likely.
std::vector<double> sum_distribution(const std::vector<std::size_t>& ranks) {
    std::vector<double> probability{1};
    for (const std::size_t rank : ranks) {
        std::vector<double> next(probability.size() + rank);
        for (std::size_t sum = 0; sum < probability.size(); ++sum) {
            next[sum] += probability[sum] / 2;
            next[sum + rank] += probability[sum] / 2;
        }
        probability = std::move(next);
    }
    return probability;
}

} // namespace

SignedRankTest signed_rank_test(std::span<const double> differences) {
    std::vector<double> ordered(differences.begin(), differences.end());
    std::erase(ordered, 0.0);
    std::ranges::sort(ordered, {}, [](double d) { return std::abs(d); });
    std::vector<double> magnitudes;
    std::ranges::transform(ordered, std::back_inserter(magnitudes), [](double d) { return std::abs(d); });
    const std::vector<std::size_t> ranks = doubled_ranks(magnitudes);
    std::size_t sum = 0;
    for (std::size_t i = 0; i < ordered.size(); ++i) {
        sum += ordered[i] > 0 ? ranks[i] : 0;
    }
    const std::vector<double> probability = sum_distribution(ranks);
    const auto at_sum = probability.begin() + static_cast<std::ptrdiff_t>(sum);
    return {static_cast<double>(sum) / 2, static_cast<int>(ordered.size()),
            std::min(1.0, std::accumulate(probability.begin(), at_sum + 1, 0.0)),
            std::min(1.0, std::accumulate(at_sum, probability.end(), 0.0))};
}

} // namespace dfdyn::tools
