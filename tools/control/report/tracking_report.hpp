// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/system/file_set.hpp"
#include "tools/control/report/tracking.hpp"

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The windows of one run, and its name: "nominal", "learned".
struct TrackingRun {
    std::string name;
    std::vector<TrackingWindow> windows;
};

/// Prints a line per window: each run's error over all joints (mrad), and the ratio of the first run's to the
/// last run's. Prints nothing for runs without a complete window. `runs`: at least one, all with the same
/// number of windows.
void print_tracking(std::ostream& out, const std::vector<TrackingRun>& runs);

/// Returns the windows of all runs, schema `dfdyn.loop/1`; `stopped`: whether a loop stopped by itself.
nlohmann::ordered_json tracking_json(const std::vector<TrackingRun>& runs, bool stopped);

/// Adds tracking.csv (per run and window: error over all joints and of each joint, mrad; share of the
/// learned model), tracking.svg, and tracking.html with both in `folder`, which exists or is in
/// `files`. Adds nothing for runs without a complete window.
void add_tracking(const std::filesystem::path& folder, const std::string& title,
                  const std::vector<TrackingRun>& runs, FileSet& files);

} // namespace dfdyn::tools
