// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace dfdyn::tools {

/// A polynomial of this degree is fitted to the samples up to `half_width` before and after each one.
struct ZeroPhaseWindow {
    int half_width = 10;
    int degree = 3; ///< 2 at least, 2 half_width at most
};

/// One row per sample, one column per signal.
struct SampledDerivatives {
    Eigen::MatrixXd first, second;   ///< per s, per s²
    std::vector<std::uint8_t> valid; ///< 1 where the whole window lies within the recording, without a gap
};

/// Derivatives of `columns` of a recording by least-squares polynomials centred on each sample
/// (Savitzky–Golay, with the samples' own times): without phase lag, hence offline only. No window reaches
/// over a gap: one that the recording marks, or a time step above three times the median. Cost: rows ·
/// half_width · degree².
SampledDerivatives zero_phase_derivatives(const Recording& recording, const Columns& columns,
                                          const ZeroPhaseWindow& window);

} // namespace dfdyn::tools
