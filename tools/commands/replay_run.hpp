// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/system/file_place.hpp"
#include "tools/commands/options/contact_options.hpp"
#include "tools/commands/options/monitor_options.hpp"
#include "tools/commands/options/options.hpp"
#include "tools/replay/replay_interface.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The options of `dfdyn replay`.
struct ReplayOptions {
    std::vector<std::filesystem::path> models; ///< several: combined
    RecordingOptions recordings;
    std::filesystem::path csv;
    std::filesystem::path report;
    std::optional<std::size_t> horizon;
    bool from_prior = false;
    bool frozen = false;
    MonitorOptions monitor;
    ContactOptions contacts;
    bool json = false;

    std::filesystem::path bus; ///< if given, the recordings are candump logs, or the source is an interface
    std::string log_interface;
    InterfaceOptions can;

    bool live() const { return !can.interface.empty(); }
    /// Returns the file of all ticks to which a thinned page links: the output, if it is in the page's
    /// folder; otherwise R.ticks.csv there.
    std::filesystem::path full_data() const {
        std::error_code ignored;
        if (report.empty() || (std::filesystem::exists(report, ignored) &&
                               !std::filesystem::is_regular_file(report, ignored))) {
            return {}; // a pipe has no folder for a further file
        }
        return !csv.empty() && in_same_folder(csv, report)
                   ? csv
                   : std::filesystem::path(report).replace_extension(".ticks.csv");
    }
    /// In real time the default is no index, because of its cost.
    std::size_t chosen_horizon() const { return horizon.value_or(live() ? 0 : 25); }
};

/// Replays the recordings or the bus and writes what the options ask for. Returns the exit status. Throws
/// InputError for options that contradict each other.
int run_replay_command(const ReplayOptions& options);

} // namespace dfdyn::tools
