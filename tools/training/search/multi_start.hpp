// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/likelihood/likelihood.hpp"
#include "tools/training/search/minimise.hpp"
#include "tools/training/training_options.hpp"
#include "tools/training/training_progress.hpp"

#include <mutex>
#include <vector>

namespace dfdyn::tools {

/// Local searches of likelihoods on `options.threads` threads, with a common count of evaluations over all
/// runs. Refers to both arguments.
class MultiStart {
  public:
    /// `searches`: number of all searches, for the progress display, without the refinement.
    MultiStart(const TrainingOptions& options, const ProgressCallback& callback, int searches)
        : options_(options), callback_(callback) {
        progress_.evaluations_most =
            searches * options.evaluations_per_start + options.refinement_evaluations;
    }

    /// Returns one Minimum per start, in order, with the value -2 log L; each search depends on its own start
    /// only. `announced`: the callback receives the end of every search. An exception of a search is
    /// rethrown.
    std::vector<Minimum> run(const Likelihood& likelihood, const Bounds& bounds,
                             const std::vector<Eigen::VectorXd>& starts, bool announced);

    /// Runs one search with the evaluation limit of the refinement.
    Minimum refine(const Likelihood& likelihood, const Bounds& bounds, const Eigen::VectorXd& start);

  private:
    /// `tolerance`: of -2 log L; at most `evaluations`.
    Minimum search(const Likelihood& likelihood, const Bounds& bounds, const Eigen::VectorXd& start,
                   double tolerance, int evaluations);
    void report(int evaluations, const std::optional<TrainingProgress::End>& end);

    const TrainingOptions& options_;
    const ProgressCallback& callback_;
    std::mutex mutex_;
    TrainingProgress progress_;
};

} // namespace dfdyn::tools
