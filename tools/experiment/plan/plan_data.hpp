// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/experiment/plan/plan.hpp"

#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

/// The recordings of a plan, divided as the plan describes.
struct PlanData {
    Recording start;  ///< first rows of the training log: for hyperparameters and the initial state
    Recording online; ///< the rest of it
    std::vector<Recording> subsets;
    std::vector<double> output_variance;                 ///< of each output over all subsets
    std::vector<std::vector<std::size_t>> group_outputs; ///< indices of each group's outputs
    std::vector<std::pair<std::string, std::string>>
        checksums; ///< of each recording and of the robot: file name, checksum
};

/// Reads the recordings. Throws InputError as `read_recording` does, for a recording with fewer rows than the
/// plan requires, for missing outputs, and for rows whose sample period differs from the start's by more than
/// `followed_deviation`.
PlanData load_plan_data(const Plan& plan);

} // namespace dfdyn::tools
