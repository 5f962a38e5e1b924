// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// The modified discrete cosine transform: an orthonormal lapped transform (H. S. Malvar, "Signal Processing
/// with Lapped Transforms", 1992), of which only the lowest frequencies are kept. The window is the
/// power-complementary sine of a squared sine of Vorbis I, which leaks little. Its coefficients of coloured
/// stationary noise are nearly independent, with the noise's spectral density as variance: so that least
/// squares over them, weighed per frequency, know the noise's colour, and blocks of them are blocks of time.
/// Frames of 2 `hop` samples, one every `hop`. Cost of a signal of T samples: 4 T bins.
class LappedTransform {
  public:
    /// `hop`: samples; 1 <= bins <= hop.
    LappedTransform(Eigen::Index hop, Eigen::Index bins);

    Eigen::Index hop() const noexcept { return hop_; }
    Eigen::Index bins() const noexcept { return basis_.rows(); }
    /// Of a stretch of this many samples; 0 when it is shorter than a frame.
    Eigen::Index frames(Eigen::Index samples) const noexcept {
        return samples < 2 * hop_ ? 0 : samples / hop_ - 1;
    }

    /// 2 hop: how much of a white noise's energy in a frame each sample of it has; they add to one.
    const Eigen::VectorXd& window_squares() const noexcept { return window_squares_; }

    /// bins x frames coefficients of `signal`, a stretch without gaps; samples behind the last whole frame do
    /// not count.
    Eigen::MatrixXd analyse(const Eigen::Ref<const Eigen::VectorXd>& signal) const;

    /// The transpose of `analyse`: a signal of `samples`.
    Eigen::VectorXd synthesise(const Eigen::Ref<const Eigen::MatrixXd>& coefficients,
                               Eigen::Index samples) const;

  private:
    Eigen::Index hop_;
    Eigen::MatrixXd basis_; ///< bins x 2 hop
    Eigen::VectorXd window_squares_;
};

} // namespace dfdyn::tools
