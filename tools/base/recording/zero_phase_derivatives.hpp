// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace dfdyn::tools {

/// Window of a polynomial fit of this degree: the samples up to `half_width` before and after each one.
struct ZeroPhaseWindow {
    int half_width = 10;
    int degree = 3; ///< at least 2, at most 2 half_width
};

/// One row per sample, one column per signal.
struct SampledDerivatives {
    Eigen::MatrixXd first, second;   ///< per s, per s²
    std::vector<std::uint8_t> valid; ///< 1 if the whole window lies within the recording, without a gap
};

/// Returns the derivatives of `columns` of a recording by least-squares polynomials centred on each sample
/// (Savitzky–Golay, with the samples' own times). They have no phase delay and are therefore for offline use
/// only. No window extends across a gap: one marked by the recording, or a time step longer than three times
/// the median. Cost: rows · half_width · degree².
SampledDerivatives zero_phase_derivatives(const Recording& recording, const Columns& columns,
                                          const ZeroPhaseWindow& window);

} // namespace dfdyn::tools
