// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/robot/dynamics/joint_vector.hpp"

namespace dfdyn::tools {

/// First-order or second-order Butterworth low-pass filter for six channels, by the bilinear transform with
/// prewarping: its -3 dB frequency equals the requested bandwidth exactly.
class LowPass {
  public:
    /// `order`: 1 or 2. `bandwidth_hz`: below half of 1 / `period_s`.
    LowPass(int order, double bandwidth_hz, double period_s) noexcept;

    /// Filters one sample. The first call starts in the steady state for `input`.
    Wrench filter(const Wrench& input) noexcept;

  private:
    double input_[3];  ///< coefficients, newest first
    double output_[2]; ///< of the past outputs
    Wrench past_input_[2];
    Wrench past_output_[2];
    bool started_ = false;
};

} // namespace dfdyn::tools
