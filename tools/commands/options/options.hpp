// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <CLI/CLI.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The options with which every subcommand names its recordings.
struct RecordingOptions {
    std::vector<std::filesystem::path> logs;
    std::string rows = ":";
    bool skip_bad_rows = false;

    void add_to(CLI::App& command);

    /// Reads them all, and says once on stderr which columns were ignored and which rows skipped.
    std::vector<Recording> read(std::size_t joint_count, OutputKind outputs) const;

    /// Likewise, the columns that `options` says.
    std::vector<Recording> read(ReadOptions options) const;
};

/// Throws InputError when two outputs, or an output and an input, are the same file. Empty paths are none.
void check_distinct(const std::vector<std::filesystem::path>& outputs,
                    std::vector<std::filesystem::path> inputs);

/// Call before the work: check_distinct(), and InputError when an output cannot be written.
void check_outputs(const std::vector<std::filesystem::path>& outputs,
                   std::vector<std::filesystem::path> inputs);

/// The kind of outputs that has these column names; throws InputError when none has.
OutputKind kind_of_outputs(const std::vector<std::string>& names, std::size_t joint_count);

} // namespace dfdyn::tools
