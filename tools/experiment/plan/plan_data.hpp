// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/experiment/plan/plan.hpp"

#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

/// The recordings of a plan, cut as it says.
struct PlanData {
    Recording start;  ///< the first rows of the training log: hyperparameters and start
    Recording online; ///< the rest of it
    std::vector<Recording> subsets;
    std::vector<double> output_variance;                 ///< of each output over all subsets
    std::vector<std::vector<std::size_t>> group_outputs; ///< the outputs of each group, by their number
    std::vector<std::pair<std::string, std::string>>
        checksums; ///< of each recording and the robot: file name, checksum
};

/// Reads them. Throws InputError for recordings as `read_recording` does, for one with fewer rows than the
/// plan asks for, and for an output that they do not have.
PlanData load_plan_data(const Plan& plan);

} // namespace dfdyn::tools
