// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/training/marginal_likelihood.hpp"
#include "tools/training/minimise.hpp"
#include "tools/training/train.hpp"

#include <vector>

namespace dfdyn::tools {

/// Runs `options.starts` local searches of the likelihood on `options.threads` threads. One Minimum per
/// start, in their order, its value -2 log L; each search depends on the seed and its own number only. An
/// exception of a search is passed on.
std::vector<Minimum> search_all_starts(const MarginalLikelihood& likelihood, const TrainingOptions& options,
                                       const ProgressCallback& progress);

} // namespace dfdyn::tools
