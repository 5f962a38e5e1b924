// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/common/atomic_file.hpp"
#include "tools/control/closed_loop.hpp"
#include "tools/recording/csv_writer.hpp"

#include <filesystem>

namespace dfdyn::tools {

/// A closed loop's measured positions and torques as a recording that `dfdyn train` reads. The file appears
/// with `commit`.
class LoopRecording {
  public:
    /// `every`: ticks of a row.
    LoopRecording(const std::filesystem::path& path, std::size_t joints, int every);

    /// One tick; it gives no row if something was not measured.
    void add(const ClosedLoopInstant& instant);
    void commit() { file_.commit(); }

  private:
    AtomicFile file_;
    CsvWriter csv_;
    int every_;
    long tick_ = 0;
};

} // namespace dfdyn::tools
