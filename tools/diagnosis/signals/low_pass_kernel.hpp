// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// A symmetric low pass, weights that add to one: sinc under a Blackman window over four periods of `cutoff`
/// (cycles per sample, above 0 and below 1/2), -6 dB there, flat below and -70 dB above it by 1.4 `cutoff`.
Eigen::VectorXd low_pass_kernel(double cutoff);

/// Every `step`-th sample of `signal` convolved with `kernel`. Beyond its ends the signal goes on mirrored in
/// the end point, so that offset and slope are kept.
Eigen::VectorXd filtered(const Eigen::Ref<const Eigen::VectorXd>& signal, const Eigen::VectorXd& kernel,
                         Eigen::Index step = 1);

/// Derivative by the central difference of fourth order (second at the ends), per sample.
Eigen::VectorXd differentiated(const Eigen::Ref<const Eigen::VectorXd>& signal);

} // namespace dfdyn::tools
