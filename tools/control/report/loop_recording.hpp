// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/control/loop/control_loop.hpp"

#include <ostream>
#include <vector>

namespace dfdyn::tools {

/// Records a loop's measured positions and torques in the format that `dfdyn train` reads. The data stays in
/// memory of fixed size until `write`, so that a tick never waits for a disk.
class LoopRecording {
  public:
    /// `every`: ticks per row. Rows after `duration_s` are left out.
    LoopRecording(int joints, int every, double period_s, double duration_s);

    /// Adds one tick, unless a measurement is missing.
    void add(const LoopInput& input);

    /// Writes the recording, with times counted from the first row.
    void write(std::ostream& out) const;

  private:
    std::size_t joints_;
    int every_;
    long tick_ = 0;
    std::vector<std::int64_t> time_ns_;
    std::vector<double> values_; ///< per row: positions, then torques
};

} // namespace dfdyn::tools
