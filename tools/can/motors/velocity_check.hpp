// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/decoded.hpp"

#include <cstdint>

namespace dfdyn::tools {

/// Compares the velocities that a device reports with the changes of its positions: slope of a straight line
/// through both, by least squares over the steps between positions. A constant error of the velocity does not
/// matter. Positions and velocities may come in different frames.
class VelocityCheck {
  public:
    /// Takes the values of one joint in a frame.
    void take(const hal::JointValue& value) noexcept;

    /// Ratio of the change of the positions to the integral of the velocity; 1 if there is nothing to
    /// compare, 0 if the positions are constant.
    double ratio() const noexcept;
    /// Standard error of `ratio`.
    double ratio_error() const noexcept;
    double distance_rad() const noexcept { return distance_rad_; } ///< sum of the compared changes

    /// True if enough was compared to state the ratio.
    bool is_sure() const noexcept;
    /// True if the positions move by more than noise, but not with the velocities: they are other data.
    bool is_unrelated() const noexcept;
    /// True if the ratio differs significantly from 1.
    bool contradicts() const noexcept;

  private:
    std::int64_t position_ns_ = 0;
    double position_rad_ = 0;
    double last_velocity_ = 0; ///< rad/s, at the last position
    double velocity_ = 0;      ///< rad/s, the newest
    std::int64_t velocity_ns_ = 0;
    bool has_position_ = false, has_velocity_ = false;
    void add(double expected_rad, double moved_rad, double step_s) noexcept;
    bool stands() const noexcept;
    bool varies() const noexcept;

    /// Sums over the steps: of the expected and the measured change (rad), and of their products.
    double steps_ = 0, expected_ = 0, moved_ = 0, squares_ = 0, products_ = 0, moved_squares_ = 0;
    double velocities_ = 0, velocity_squares_ = 0; ///< sums of the reported velocities
    double distance_rad_ = 0, expected_distance_rad_ = 0;
};

} // namespace dfdyn::tools
