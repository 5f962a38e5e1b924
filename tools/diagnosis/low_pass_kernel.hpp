// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// A symmetric low pass, 2 half + 1 weights that add to one: sinc under a Blackman window, -6 dB at `cutoff`
/// (cycles per sample, below 1/2), flat below and -70 dB above it by 1.4 `cutoff` when half >= 2 / cutoff.
Eigen::VectorXd low_pass_kernel(double cutoff, Eigen::Index half);

/// Every `step`-th sample of `signal` convolved with `kernel`. Beyond its ends the signal goes on mirrored in
/// the end point, so that offset and slope are kept.
Eigen::VectorXd filtered(const Eigen::Ref<const Eigen::VectorXd>& signal, const Eigen::VectorXd& kernel,
                         Eigen::Index step = 1);

/// Derivative by the central difference of fourth order (second at the ends), per sample.
Eigen::VectorXd differentiated(const Eigen::Ref<const Eigen::VectorXd>& signal);

} // namespace dfdyn::tools
