// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Returns a symmetric low-pass kernel whose weights add up to one: a sinc with a Blackman window over four
/// periods of `cutoff` (cycles per sample, between 0 and 1/2). Attenuation: 6 dB at `cutoff`, 70 dB from 1.4
/// `cutoff` on.
Eigen::VectorXd low_pass_kernel(double cutoff);

/// Returns every `step`-th sample of `signal` convolved with `kernel`. The signal is extended by point
/// reflection at its ends, which preserves offset and slope.
Eigen::VectorXd filtered(const Eigen::Ref<const Eigen::VectorXd>& signal, const Eigen::VectorXd& kernel,
                         Eigen::Index step = 1);

/// Returns the derivative per sample by central differences of fourth order (second order at the ends).
Eigen::VectorXd differentiated(const Eigen::Ref<const Eigen::VectorXd>& signal);

} // namespace dfdyn::tools
