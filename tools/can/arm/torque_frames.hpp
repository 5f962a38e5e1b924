// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/description/bus_description.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

/// Encodes and decodes torque commands from a control loop to the devices of a bus description.
///
/// - Boards of a family with a joint torque command (Board::torque_command) use that command.
/// - All other joints use frames of `dfdyn`'s own, because their families have no public command: 29-bit
///   identifier 0x1DFD000 + k, 8 bytes: torques of joints 2k+1 and 2k+2 (N·m, float, little-endian); 0 for a
///   joint that does not exist.
class TorqueFrames {
  public:
    explicit TorqueFrames(const BusDescription& description);

    /// Encodes one torque (N·m) per joint. The result is valid until the next call.
    std::span<const hal::Frame> encode(std::span<const double> torque);

    /// Writes the torques commanded by `frame` into `torque`. Returns false if `frame` is not a torque
    /// command, or if a torque is not a number.
    bool take(const hal::Frame& frame, std::span<double> torque) const;

  private:
    struct Drive {
        AnyBoard board;
        int half;          ///< joint of the board, 0 or 1
        std::size_t joint; ///< joint of the arm
    };

    std::size_t joints_;
    std::vector<Drive> drives_;
    bool own_frames_ = false; ///< some joints are on boards without a torque command
    std::vector<hal::Frame> frames_;
};

} // namespace dfdyn::tools
