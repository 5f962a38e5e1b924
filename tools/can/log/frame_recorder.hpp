// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"
#include "tools/base/system/atomic_file.hpp"

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>
#include <utility>

namespace dfdyn::tools {

/// Writes frames as a candump log with nanoseconds, which CandumpLog reads back unchanged.
class FrameWriter {
  public:
    /// `out` must outlive the writer. `interface`: the name of the bus in the log.
    FrameWriter(std::ostream& out, std::string interface);

    /// `dropped`: number of frames lost since the previous one. Throws std::logic_error for a frame that no
    /// bus can carry.
    void write(const hal::Frame& frame, std::uint64_t dropped = 0);

  private:
    std::ostream& out_;
    std::string interface_;
    std::uint64_t dropped_ = 0;
};

/// A log file of frames that becomes visible with `commit`.
class FrameRecorder {
  public:
    FrameRecorder(const std::filesystem::path& path, std::string interface)
        : file_(path), writer_(file_.stream(), std::move(interface)) {}

    void write(const hal::Frame& frame) { writer_.write(frame); }
    void commit() { file_.commit(); }

  private:
    AtomicFile file_;
    FrameWriter writer_;
};

} // namespace dfdyn::tools
