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

/// Writes frames as a candump log with nanoseconds, which CandumpLog reads back as they were.
class FrameWriter {
  public:
    /// `out` must outlive the writer. `interface`: the name that the log gives the bus.
    FrameWriter(std::ostream& out, std::string interface);

    /// `dropped`: frames that were lost since the one before. Throws std::logic_error for a frame that no
    /// bus carries.
    void write(const hal::Frame& frame, std::uint64_t dropped = 0);

  private:
    std::ostream& out_;
    std::string interface_;
    std::uint64_t dropped_ = 0;
};

/// A log of frames that appears with `commit`.
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
