// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/replay_bus.hpp"
#include "tools/base/system/line_reader.hpp"

#include <exception>
#include <filesystem>
#include <string>

namespace dfdyn::tools {

/// Reads a candump log line by line in bounded memory. It is the source of a ReplayBus (`ReplaySource`) or of
/// any loop over its frames. A bus is one interface: if the log has several, one must be chosen.
///
///     CandumpLog log(path);
///     hal::ReplayBus bus(log);
///     while (!bus.ended()) { … }
///     log.check();
class CandumpLog {
  public:
    /// `interface`: the interface whose frames are read; empty for a log that has only one. Throws InputError
    /// if the file cannot be opened.
    explicit CandumpLog(const std::filesystem::path& path, std::string interface = {});

    /// Reads the next frame. Returns false at the end, and permanently once the log becomes unreadable. A
    /// malformed last line without a line end was cut off when the recording was killed; it is skipped (see
    /// `torn_line`).
    bool next(hal::ReplayEntry& entry) noexcept;

    /// A warning that names the skipped last line after it was read; otherwise empty.
    const std::string& torn_line() const noexcept { return torn_line_; }

    /// Throws the InputError, with line and column, that ended the reading early, if there was one.
    void check() const;

  private:
    bool read(hal::ReplayEntry& entry);
    bool is_chosen(std::string_view interface);
    std::string place() const;

    std::filesystem::path path_;
    std::string interface_;
    bool is_only_one_; ///< the log must not have another interface
    LineReader lines_;
    std::string torn_line_;
    std::exception_ptr fault_;
};

/// Prints the warning about a skipped last line to stderr, if there is one.
void warn_of_torn_line(const CandumpLog& log);

} // namespace dfdyn::tools
