// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/report/tracking.hpp"

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

/// A line per window: the error of each run over all joints (mrad), and the first run's over the last's.
/// Nothing for runs without a whole window. `runs`: at least one, all of as many windows.
void print_tracking(std::ostream& out, const std::vector<TrackingRun>& runs);

/// Writes into `folder` tracking.csv (per run and window: over all joints and of each, mrad; share of the
/// learned model), tracking.svg, and tracking.html with both; nothing for runs without a whole window. Each
/// file appears whole or not at all.
void write_tracking(const std::filesystem::path& folder, const std::string& title,
                    const std::vector<TrackingRun>& runs);

} // namespace dfdyn::tools
