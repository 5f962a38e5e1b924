// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/description/bus_description.hpp"

#include <span>
#include <vector>

namespace dfdyn::tools {

/// Torque commands from a loop to the devices of a bus description, both sides.
///
/// - Boards whose family has a command of joint torques (Board::torque_command): that command.
/// - All other joints: `dfdyn`'s own frames, since those families have no public one:
///   29-bit identifier 0x1DFD000 + k, 8 bytes: the torques of joints 2k+1 and 2k+2 in N·m, float, little
///   endian; 0 for a joint that is not there.
class TorqueFrames {
  public:
    explicit TorqueFrames(const BusDescription& description);

    /// Of one torque per joint, N·m. The result lives until the next call.
    std::span<const hal::Frame> encode(std::span<const double> torque);

    /// Takes the torques that `frame` commands into `torque`; false where it is no command, or commands what
    /// is not a number.
    bool take(const hal::Frame& frame, std::span<double> torque) const;

  private:
    struct Drive {
        AnyBoard board;
        std::size_t joint;
    };

    std::size_t joints_;
    std::vector<Drive> drives_;
    bool own_frames_ = false; ///< for the joints that are on no such board
    std::vector<hal::Frame> frames_;
};

} // namespace dfdyn::tools
