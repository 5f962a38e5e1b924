// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace dfdyn::tools {

/// Modified discrete cosine transform (MDCT): an orthonormal lapped transform (H. S. Malvar, "Signal
/// Processing with Lapped Transforms", 1992), limited to the lowest frequencies. The window is the
/// power-complementary window of Vorbis I, which has little leakage.
///
/// The coefficients of coloured stationary noise are nearly independent, and their variance is the spectral
/// density. Least squares with a weight per frequency therefore accounts for coloured noise, and blocks of
/// coefficients correspond to blocks of time. A frame has 2 `hop` samples and starts every `hop` samples.
/// Cost for a signal of T samples: 4 T bins.
class LappedTransform {
  public:
    /// `hop`: samples; 1 <= bins <= hop.
    LappedTransform(Eigen::Index hop, Eigen::Index bins);

    Eigen::Index hop() const noexcept { return hop_; }
    Eigen::Index bins() const noexcept { return basis_.rows(); }
    /// Returns the number of frames in a segment of `samples`; 0 if it is shorter than one frame.
    Eigen::Index frames(Eigen::Index samples) const noexcept {
        return samples < 2 * hop_ ? 0 : samples / hop_ - 1;
    }

    /// Returns, for each of the 2 hop samples, its share of the energy of white noise in a frame. The shares
    /// add up to one.
    const Eigen::VectorXd& window_squares() const noexcept { return window_squares_; }

    /// Returns the coefficients (bins x frames) of `signal`, a segment without gaps. Samples after the last
    /// complete frame are ignored.
    Eigen::MatrixXd analyse(const Eigen::Ref<const Eigen::VectorXd>& signal) const;

    /// Applies the transpose of `analyse`. Returns a signal of `samples`.
    Eigen::VectorXd synthesise(const Eigen::Ref<const Eigen::MatrixXd>& coefficients,
                               Eigen::Index samples) const;

  private:
    Eigen::Index hop_;
    Eigen::MatrixXd basis_; ///< bins x 2 hop
    Eigen::VectorXd window_squares_;
};

} // namespace dfdyn::tools
