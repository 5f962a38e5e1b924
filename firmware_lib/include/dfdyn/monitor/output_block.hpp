// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/strict_math.hpp"

namespace dfdyn {

inline constexpr int payload_columns =
    4;                                  ///< mass, first moment about the tool's tip, in the last link's frame
inline constexpr int force_columns = 3; ///< force on the arm at the tool's tip, in the base frame
inline constexpr int friction_columns = 2; ///< Coulomb and viscous, at the output's own joint

/// Summary of a block of samples of one output: means over the block, and columns. The columns are partial
/// derivatives of the output, in its unit: with respect to a payload and a force (in the middle of the block)
/// and to friction (mean).
template <class Scalar>
struct OutputBlock {
    Scalar innovation; ///< divided by its predicted standard deviation
    Scalar deviation;  ///< predicted standard deviation of the innovation, output units
    Scalar residual;   ///< measurement minus prediction with delayed weights (`DelayedWeights`), output units
    Scalar speed;      ///< magnitude for the output's joint, rad/s or m/s; 0 for a wrench
    Scalar payload[payload_columns];
    Scalar force[force_columns];
    Scalar friction[friction_columns];
};

} // namespace dfdyn
