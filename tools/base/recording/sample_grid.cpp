// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/sample_grid.hpp"

#include "dfdyn/core/sample_clock.hpp"
#include "tools/base/numerics/quantile.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr double same_period = 0.01; // relative
constexpr int refinements = 4;

std::int64_t step_ns(const Recording& recording, std::size_t row) {
    return recording.time_ns[row] - recording.time_ns[row - 1];
}

/// Mean of the steps without a loss, for this nominal period; `period_s` if there are none.
double mean_step_s(std::span<const Recording> recordings, double period_s) {
    double total_s = 0;
    double count = 0;
    for (const Recording& recording : recordings) {
        const std::vector<std::uint8_t> restarts = window_restarts(recording, period_s);
        for (std::size_t row = 1; row < recording.row_count(); ++row) {
            if (restarts[row] == 0) {
                total_s += 1e-9 * static_cast<double>(step_ns(recording, row));
                ++count;
            }
        }
    }
    return count > 0 ? total_s / count : period_s;
}

/// Returns the steps (s) between every `stride`-th row of each recording.
std::vector<double> steps_of_every(std::size_t stride, std::span<const Recording> recordings) {
    std::vector<double> steps_s;
    for (const Recording& recording : recordings) {
        for (std::size_t row = stride; row < recording.row_count(); row += stride) {
            steps_s.push_back(1e-9 *
                              static_cast<double>(recording.time_ns[row] - recording.time_ns[row - stride]));
        }
    }
    return steps_s;
}

/// Does the same as sample_period_s() without a comparison of the recordings.
double common_period_s(std::span<const Recording> recordings) {
    std::vector<double> steps_s;
    for (const Recording& recording : recordings) {
        for (std::size_t row = 1; row < recording.row_count(); ++row) {
            steps_s.push_back(1e-9 * static_cast<double>(step_ns(recording, row)));
        }
    }
    if (steps_s.empty()) {
        throw InputError(recordings.front().source + ": expected at least two rows to train on, found one");
    }
    const double middle_s = median(std::move(steps_s));
    double period_s = middle_s;
    for (int refinement = 0; refinement < refinements; ++refinement) {
        period_s = mean_step_s(recordings, period_s);
    }
    return std::abs(period_s / middle_s - 1) <= same_period ? middle_s : period_s;
}

[[noreturn]] void refuse_period(const Recording& recording, double found_s, double expected_s,
                                const std::string& where) {
    throw InputError(recording.source + ": expected a row every " + rounded_text(expected_s) + " s, as in " +
                     where + ", found one every " + rounded_text(found_s) + " s");
}

/// Refuses a recording whose period is shorter than that of the training of `model`, or more than `most`
/// times as long; one of one row has none.
void check_period(const Recording& recording, double period_s, double most, const std::string& model) {
    if (recording.row_count() > 1) {
        const double own_s = common_period_s({&recording, 1});
        if (own_s < (1 - followed_deviation) * period_s || own_s > most * period_s) {
            refuse_period(recording, own_s, period_s, "the training of " + model);
        }
    }
}

/// Refuses recordings with another period than the first one; those of one row have none.
void check_same_period(std::span<const Recording> recordings) {
    const Recording* first = nullptr;
    double first_s = 0;
    for (const Recording& recording : recordings) {
        if (recording.row_count() < 2) {
            continue;
        }
        const double own_s = common_period_s({&recording, 1});
        if (first == nullptr) {
            first = &recording;
            first_s = own_s;
        } else if (std::abs(own_s / first_s - 1) > followed_deviation) {
            refuse_period(recording, own_s, first_s, first->source);
        }
    }
}

} // namespace

double sample_period_s(std::span<const Recording> recordings) {
    if (recordings.size() > 1) {
        check_same_period(recordings);
    }
    return common_period_s(recordings);
}

void check_not_faster(const Recording& recording, double period_s, const std::string& model) {
    check_period(recording, period_s, std::numeric_limits<double>::infinity(), model);
}

void check_period(const Recording& recording, double period_s, const std::string& model) {
    check_period(recording, period_s, 1 + followed_deviation, model);
}

SteadyStride steady_stride(std::span<const Recording> recordings) {
    constexpr std::size_t longest = 8;
    constexpr double steady_share = 0.97;
    constexpr double same_step = 0.1; // relative
    for (std::size_t stride = 2; stride <= longest; ++stride) {
        const std::vector<double> steps_s = steps_of_every(stride, recordings);
        if (steps_s.empty()) {
            return {};
        }
        const double middle_s = median(steps_s);
        const auto steady = std::ranges::count_if(
            steps_s, [&](double step_s) { return std::abs(step_s / middle_s - 1) <= same_step; });
        if (static_cast<double>(steady) >= steady_share * static_cast<double>(steps_s.size())) {
            return {stride, middle_s};
        }
    }
    return {};
}

std::vector<std::uint8_t> window_restarts(const Recording& recording, double period_s) {
    const std::int64_t period_ns = std::llround(1e9 * period_s);
    SampleClock clock;
    std::vector<std::uint8_t> result = recording.gap_before;
    result.resize(recording.row_count(), 0);
    for (std::size_t row = 1; row < recording.row_count(); ++row) {
        const bool lost = clock.lost_before(static_cast<std::uint64_t>(step_ns(recording, row)), period_ns);
        result[row] = lost || result[row] != 0 ? 1 : 0;
    }
    return result;
}

} // namespace dfdyn::tools
