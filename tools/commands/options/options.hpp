// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The options for recordings, common to all subcommands.
struct RecordingOptions {
    std::vector<std::filesystem::path> logs;
    std::string rows = ":";
    bool skip_bad_rows = false;
    std::string columns, units; ///< as for parse_column_patterns() and parse_units()

    std::vector<std::string> topics; ///< of ROS 2 bags

    void add_to(CLI::App& command);

    /// Returns whether the user gave an option besides the files.
    bool has_choice() const {
        return rows != ":" || skip_bad_rows || !columns.empty() || !units.empty() || !topics.empty();
    }

    /// Returns the files of the recordings, and `others`: what no output may replace.
    std::vector<std::filesystem::path> with(const std::vector<std::filesystem::path>& others) const;

    /// Reads all recordings with the columns of `options`. Reports ignored columns, assumptions and skipped
    /// rows once on stderr.
    std::vector<Recording> read(ReadOptions options) const;

    /// Does the same. Throws InputError if a recording is given twice: its noise would count as known.
    std::vector<Recording> read_each_once(const ReadOptions& options) const;
};

/// Throws InputError with this message for options that are `wrong` together.
void refuse(bool wrong, const char* message);

/// Throws InputError if two outputs, or an output and an input, are the same file. Empty paths are ignored.
void check_distinct(const std::vector<std::filesystem::path>& outputs,
                    std::vector<std::filesystem::path> inputs);

/// Call before the work: runs check_distinct(), and throws InputError if an output is not writable.
void check_outputs(const std::vector<std::filesystem::path>& outputs,
                   std::vector<std::filesystem::path> inputs);

/// Returns the kind of outputs with these column names. Throws InputError if there is none.
OutputKind kind_of_outputs(const std::vector<std::string>& names, std::size_t joint_count);

} // namespace dfdyn::tools
