// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/nearest_name.hpp"

#include "tools/base/text/text.hpp"

#include <algorithm>
#include <array>
#include <vector>

namespace dfdyn::tools {
namespace {

constexpr std::size_t longest_name = 100;

std::string lower_case(std::string_view text) {
    std::string lower(text);
    std::ranges::transform(lower, lower.begin(), [](char letter) {
        return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
    });
    return lower;
}

/// Returns the optimal string alignment distance: insertions, removals, changes, and exchanges of neighbours.
std::size_t distance(const std::string& a, const std::string& b) {
    std::array<std::vector<std::size_t>, 3> rows; // of the last two letters of `a`, and of this one
    rows.fill(std::vector<std::size_t>(b.size() + 1));
    for (std::size_t j = 0; j <= b.size(); ++j) {
        rows[0][j] = j;
    }
    for (std::size_t i = 1; i <= a.size(); ++i) {
        const auto& before = rows[(i + 1) % 3]; // of letter i − 2
        const auto& last = rows[(i + 2) % 3];   // of letter i − 1
        auto& row = rows[i % 3];
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t changed = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
            row[j] = std::min({last[j] + 1, row[j - 1] + 1, changed});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = std::min(row[j], before[j - 2] + 1);
            }
        }
    }
    return rows[a.size() % 3].back();
}

} // namespace

std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> known) {
    if (name.size() > longest_name) {
        return std::nullopt;
    }
    const std::string wanted = lower_case(name);
    std::optional<std::string> nearest;
    std::size_t least = wanted.size() / 3 + 1;
    for (const std::string& candidate : known) {
        if (candidate.empty() || candidate.size() > longest_name) {
            continue;
        }
        const std::size_t found = distance(wanted, lower_case(candidate));
        if (found < least) {
            least = found;
            nearest = candidate;
        }
    }
    return nearest;
}

std::string suggestion(std::string_view name, std::span<const std::string> known) {
    const auto nearest = nearest_name(name, known);
    return nearest ? " (did you mean " + in_quotes(*nearest) + "?)" : "";
}

} // namespace dfdyn::tools
