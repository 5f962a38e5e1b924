// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"
#include "tools/common/atomic_file.hpp"

#include <cstdint>
#include <filesystem>
#include <string>

namespace dfdyn::tools {

/// Writes frames as a candump log with nanoseconds, which CandumpLog reads back as they were. The file
/// appears with `commit`.
class FrameRecorder {
  public:
    /// `interface`: the name that the log gives the bus.
    FrameRecorder(const std::filesystem::path& path, std::string interface);

    /// `dropped`: frames that were lost since the one before. Throws std::logic_error for a frame that no
    /// bus carries.
    void write(const hal::Frame& frame, std::uint64_t dropped = 0);

    void commit() { file_.commit(); }

  private:
    AtomicFile file_;
    std::string interface_;
    std::uint64_t dropped_ = 0;
};

} // namespace dfdyn::tools
