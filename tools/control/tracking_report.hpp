// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/tracking.hpp"

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The windows of one run, with its name: "nominal", "learned".
struct TrackingRun {
    std::string name;
    std::vector<TrackingWindow> windows;
};

/// A line per window: the error of each run over all joints (mrad), and the first run's over each other's.
void print_tracking(std::ostream& out, const std::vector<TrackingRun>& runs);

/// Writes tracking.csv (per run and window: over all joints and of each, mrad; share of the learned model)
/// and tracking.svg into `folder`. Each appears whole or not at all.
void write_tracking(const std::filesystem::path& folder, const std::vector<TrackingRun>& runs);

} // namespace dfdyn::tools
