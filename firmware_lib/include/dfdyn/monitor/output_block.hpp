// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/strict_math.hpp"

namespace dfdyn {

inline constexpr int payload_columns =
    4;                                  ///< mass, first moment about the tool's tip, in the last link's frame
inline constexpr int force_columns = 3; ///< force on the arm at the tool's tip, in the base frame
inline constexpr int friction_columns = 2; ///< Coulomb, viscous; of the output's own joint

/// What a block of samples says of one output: means over the block, and columns, which are derivatives of
/// the output, in its unit, by a payload and a force in the middle of the block and by friction.
template <class Scalar>
struct OutputBlock {
    Scalar innovation; ///< in units of its predicted standard deviation …
    Scalar deviation;  ///< … which was this
    Scalar residual;   ///< measured less predicted by what was known a while ago
    Scalar speed;      ///< of the output's joint, ≥ 0; of a wrench: 0
    Scalar payload[payload_columns];
    Scalar force[force_columns];
    Scalar friction[friction_columns];
};

} // namespace dfdyn
