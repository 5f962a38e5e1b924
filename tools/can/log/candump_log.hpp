// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/replay_bus.hpp"
#include "tools/base/text/line_reader.hpp"

#include <exception>
#include <filesystem>
#include <string>

namespace dfdyn::tools {

/// A candump log, read line by line in bounded memory: the source of a ReplayBus (`ReplaySource`), or of any
/// loop over its frames. A bus is one interface: where the log has several, one has to be chosen.
///
///     CandumpLog log(path);
///     hal::ReplayBus bus(log);
///     while (!bus.ended()) { … }
///     log.check();
class CandumpLog {
  public:
    /// `interface`: the one whose frames to give; empty for a log that has only one. Throws InputError when
    /// the file cannot be opened.
    explicit CandumpLog(const std::filesystem::path& path, std::string interface = {});

    /// The next frame; false at the end, and for good where the log becomes unreadable. A last line that is
    /// malformed and has no end was torn when the recording was killed: it is left out, see `torn_line`.
    bool next(hal::ReplayEntry& entry) noexcept;

    /// A warning that names the torn last line, once it was met; else empty.
    const std::string& torn_line() const noexcept { return torn_line_; }

    /// Throws the InputError, with line and column, that ended the reading early, if one did.
    void check() const;

  private:
    bool read(hal::ReplayEntry& entry);
    bool is_chosen(std::string_view interface);
    std::string place() const;

    std::filesystem::path path_;
    std::string interface_;
    bool is_only_one_; ///< the log may not have another interface
    LineReader lines_;
    std::string torn_line_;
    std::exception_ptr fault_;
};

/// Writes the warning about a torn last line to stderr, if there is one.
void warn_of_torn_line(const CandumpLog& log);

} // namespace dfdyn::tools
