// SPDX-License-Identifier: Apache-2.0
#include "tools/training/search/multi_start.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>

namespace dfdyn::tools {
namespace {

constexpr double log_likelihood_tolerance = 0.001; // far below the differences between models
constexpr double refinement_tolerance = 0.1;       // of -2 log L

} // namespace

std::vector<Minimum> MultiStart::run(const Likelihood& likelihood, const Bounds& bounds,
                                     const std::vector<Eigen::VectorXd>& starts, bool announced) {
    std::vector<Minimum> minima(starts.size()); // each element is written by the thread of its start
    std::atomic<std::size_t> next{0};
    const auto work = [&] {
        for (std::size_t start = next++; start < starts.size(); start = next++) {
            minima[start] = search(likelihood, bounds, starts[start], 2 * log_likelihood_tolerance,
                                   options_.evaluations_per_start);
            if (announced) {
                const double value = minima[start].value;
                report(0, TrainingProgress::End{static_cast<int>(start),
                                                std::isfinite(value) ? std::optional<double>(-0.5 * value)
                                                                     : std::nullopt});
            }
        }
    };
    std::vector<std::future<void>> threads;
    for (std::size_t i = 0; i < std::min(static_cast<std::size_t>(options_.threads), starts.size()); ++i) {
        threads.push_back(std::async(std::launch::async, work));
    }
    for (std::future<void>& thread : threads) {
        thread.get();
    }
    return minima;
}

Minimum MultiStart::refine(const Likelihood& likelihood, const Bounds& bounds, const Eigen::VectorXd& start) {
    return search(likelihood, bounds, start, refinement_tolerance, options_.refinement_evaluations);
}

Minimum MultiStart::search(const Likelihood& likelihood, const Bounds& bounds, const Eigen::VectorXd& start,
                           double tolerance, int evaluations) {
    const auto value_of = [&](const Eigen::VectorXd& theta) -> std::optional<PointValue> {
        const auto value = likelihood.evaluate(theta);
        report(1, std::nullopt);
        return value ? std::optional(PointValue{value->minus_two_log_likelihood, value->gradient})
                     : std::nullopt;
    };
    return minimise(value_of, bounds, start, tolerance, evaluations);
}

void MultiStart::report(int evaluations, const std::optional<TrainingProgress::End>& end) {
    const std::lock_guard lock(mutex_);
    progress_.evaluations += evaluations;
    progress_.end = end;
    if (callback_) {
        callback_(progress_);
    }
}

} // namespace dfdyn::tools
