// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/loop/control_loop.hpp"

#include <filesystem>
#include <vector>

namespace dfdyn::tools {

/// A loop's measured positions and torques as a recording that `dfdyn train` reads. Kept in memory, whose
/// size is fixed at construction, until it is written: a tick does not wait for a disk.
class LoopRecording {
  public:
    /// `every`: ticks of a row. `duration_s`: what is longer is left out.
    LoopRecording(int joints, int every, double period_s, double duration_s);

    /// One tick; it gives no row if something was not measured.
    void add(const LoopInput& input);

    /// Times count from the first row. The file appears whole or not at all.
    void write(const std::filesystem::path& path) const;

  private:
    std::size_t joints_;
    int every_;
    long tick_ = 0;
    std::vector<std::int64_t> time_ns_;
    std::vector<double> values_; ///< per row: positions, then torques
};

} // namespace dfdyn::tools
