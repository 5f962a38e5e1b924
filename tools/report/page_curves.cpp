// SPDX-License-Identifier: Apache-2.0
#include "tools/report/page_curves.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr double gap_in_sample_times = 10;
/// Number of gaps whose ends a thinned page always keeps. Of further gaps it has the nearest ticks kept.
constexpr std::size_t most_gaps = 5000;

using Ticks = std::vector<std::size_t>;

double median_step_s(const std::vector<double>& time_s) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < time_s.size(); ++i) {
        steps.push_back(time_s[i] - time_s[i - 1]);
    }
    if (steps.empty()) {
        return 1;
    }
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::ranges::nth_element(steps, middle);
    return *middle;
}

/// Returns the ticks after gaps.
Ticks ticks_after_gaps(const Report& report, double sample_time_s) {
    const std::vector<double>& time_s = report.time_s;
    Ticks breaks;
    auto next = report.recordings.begin();
    for (std::size_t i = 1; i < time_s.size(); ++i) {
        while (next != report.recordings.end() && next->start_s <= time_s[i - 1]) {
            ++next;
        }
        const bool begins = next != report.recordings.end() && next->start_s <= time_s[i];
        if (begins || time_s[i] - time_s[i - 1] > gap_in_sample_times * sample_time_s) {
            breaks.push_back(i);
        }
    }
    return breaks;
}

/// Adds the ticks first..last-1 at which the output or its error is extreme.
void add_extremes(const ReportSeries& series, std::size_t first, std::size_t last, Ticks& kept) {
    std::size_t least = first;
    std::size_t most = first;
    std::size_t worst = first;
    const auto error = [&](std::size_t tick) {
        const float value = std::abs(series.measured[tick] - series.predicted[tick]);
        return std::isfinite(value) ? value : -1.0F;
    };
    const auto below = [](float value, float other) { return value < other || std::isnan(other); };
    for (std::size_t tick = first; tick < last; ++tick) {
        least = below(series.measured[tick], series.measured[least]) ? tick : least;
        most = below(-series.measured[tick], -series.measured[most]) ? tick : most;
        worst = error(tick) > error(worst) ? tick : worst;
    }
    kept.insert(kept.end(), {least, most, worst});
}

/// Returns the tick of first..last-1 with the largest finite innovation; `first` if none is finite.
std::size_t largest_innovation(const ReportInnovation& innovation, std::size_t first, std::size_t last) {
    const auto size = [&](std::size_t tick) {
        const float value = innovation.normalised_squared[tick];
        return std::isfinite(value) ? value : -1.0F;
    };
    std::size_t largest = first;
    for (std::size_t tick = first; tick < last; ++tick) {
        largest = size(tick) > size(largest) ? tick : largest;
    }
    return largest;
}

/// Returns the ticks of a thinned page, ascending.
Ticks kept_ticks(const Report& report, const Ticks& breaks) {
    const std::size_t ticks = report.time_s.size();
    // of a stretch: its first tick, its largest innovation, and add_extremes()
    const std::size_t per_stretch = 1 + (report.innovation ? 1 : 0) + 3 * report.series.size();
    const std::size_t gaps = std::min(breaks.size(), most_gaps);
    const std::size_t stretches = (most_report_ticks - 2 * gaps - 1) / per_stretch;
    Ticks kept{ticks - 1};
    for (std::size_t gap = 0; gap < gaps; ++gap) {
        kept.insert(kept.end(), {breaks[gap] - 1, breaks[gap]});
    }
    for (std::size_t stretch = 0; stretch < stretches; ++stretch) {
        const std::size_t first = stretch * ticks / stretches;
        const std::size_t last = (stretch + 1) * ticks / stretches;
        kept.push_back(first);
        for (const ReportSeries& series : report.series) {
            add_extremes(series, first, last, kept);
        }
        if (report.innovation) {
            kept.push_back(largest_innovation(*report.innovation, first, last));
        }
    }
    std::ranges::sort(kept);
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    return kept;
}

/// Returns the positions in `kept` before which there is a gap.
Ticks kept_breaks(const Ticks& breaks, const Ticks& kept) {
    Ticks result;
    for (const std::size_t tick : breaks) {
        const auto after = static_cast<std::size_t>(std::ranges::lower_bound(kept, tick) - kept.begin());
        if (result.empty() || result.back() != after) {
            result.push_back(after);
        }
    }
    return result;
}

template <class Value>
std::vector<Value> at_ticks(const std::vector<Value>& values, const Ticks& ticks) {
    std::vector<Value> kept;
    kept.reserve(ticks.size());
    for (const std::size_t tick : ticks) {
        kept.push_back(values[tick]);
    }
    return kept;
}

} // namespace

bool has_thinned_page(const Report& report) { return report.time_s.size() > most_report_ticks; }

PageCurves page_curves(const Report& report) {
    const double sample_time_s = median_step_s(report.time_s);
    PageCurves page{report, ticks_after_gaps(report, sample_time_s), sample_time_s, has_thinned_page(report)};
    if (!page.thinned) {
        return page;
    }
    const Ticks kept = kept_ticks(report, page.breaks);
    page.breaks = kept_breaks(page.breaks, kept);
    page.report.time_s = at_ticks(report.time_s, kept);
    for (ReportSeries& series : page.report.series) {
        series.measured = at_ticks(series.measured, kept);
        series.predicted = at_ticks(series.predicted, kept);
        series.standard_deviation = at_ticks(series.standard_deviation, kept);
    }
    if (report.innovation) {
        page.report.innovation->normalised_squared = at_ticks(report.innovation->normalised_squared, kept);
    }
    return page;
}

} // namespace dfdyn::tools
