// SPDX-License-Identifier: Apache-2.0
#include "tools/training/multi_start.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <mutex>

namespace dfdyn::tools {
namespace {

constexpr double log_likelihood_tolerance = 0.001; // far below what separates one model from another

/// Hands the searches out to threads and reports on them one call at a time.
class MultiStart {
  public:
    MultiStart(const MarginalLikelihood& likelihood, const TrainingOptions& options,
               const ProgressCallback& callback)
        : likelihood_(likelihood), options_(options), callback_(callback),
          minima_(static_cast<std::size_t>(options.starts)) {
        progress_.evaluations_most = options.starts * options.evaluations_per_start;
    }

    std::vector<Minimum> run() {
        std::vector<std::future<void>> threads;
        for (int i = 0; i < std::min(options_.threads, options_.starts); ++i) {
            threads.push_back(std::async(std::launch::async, [this] { work(); }));
        }
        for (std::future<void>& thread : threads) {
            thread.get();
        }
        return std::move(minima_);
    }

  private:
    void work() {
        for (int start = next_++; start < options_.starts; start = next_++) {
            Minimum& minimum = minima_[static_cast<std::size_t>(start)];
            minimum = search(start);
            const bool found = std::isfinite(minimum.value);
            report(0, TrainingProgress::End{start, found ? std::optional<double>(-0.5 * minimum.value)
                                                         : std::nullopt});
        }
    }

    Minimum search(int start) {
        NormalSource random(options_.seed, static_cast<std::uint32_t>(start));
        return minimise([this](const Eigen::VectorXd& theta) { return evaluate(theta); },
                        likelihood_.bounds(), likelihood_.start(start, random), 2 * log_likelihood_tolerance,
                        options_.evaluations_per_start);
    }

    std::optional<PointValue> evaluate(const Eigen::VectorXd& theta) {
        const auto value = likelihood_.evaluate(theta);
        report(1, std::nullopt);
        if (!value) {
            return std::nullopt;
        }
        return PointValue{value->minus_two_log_likelihood, value->gradient};
    }

    void report(int evaluations, const std::optional<TrainingProgress::End>& end) {
        const std::lock_guard lock(mutex_);
        progress_.evaluations += evaluations;
        progress_.end = end;
        if (callback_) {
            callback_(progress_);
        }
    }

    const MarginalLikelihood& likelihood_;
    const TrainingOptions& options_;
    const ProgressCallback& callback_;
    std::vector<Minimum> minima_; // each written by the thread that has its start
    std::atomic<int> next_{0};
    std::mutex mutex_;
    TrainingProgress progress_;
};

} // namespace

std::vector<Minimum> search_all_starts(const MarginalLikelihood& likelihood, const TrainingOptions& options,
                                       const ProgressCallback& progress) {
    return MultiStart(likelihood, options, progress).run();
}

} // namespace dfdyn::tools
