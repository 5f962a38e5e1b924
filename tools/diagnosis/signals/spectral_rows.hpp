// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/lapped_transform.hpp"
#include "tools/diagnosis/signals/measured_motion.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Lapped-transform coefficients of a recording's series: bins x frames, with all segments in sequence. Each
/// segment is padded with zeros on both sides, so that all its rows are used. The output and the columns pass
/// through the same transform. Their noise is independent, with one variance per bin.
class SpectralRows {
  public:
    static constexpr double hop_s = 2; ///< length of a block of time; frequencies are 1 / (2 hop_s) apart
    static constexpr double highest_hz = 20;

    explicit SpectralRows(const MeasuredMotion& measured);

    Eigen::Index bins() const noexcept { return transform_.bins(); }
    Eigen::Index frames() const noexcept { return frames_; }
    Eigen::Index rows() const noexcept { return weight_.rows(); }
    Eigen::Index count() const noexcept { return bins() * frames_; }
    double frequency_hz(Eigen::Index bin) const noexcept {
        return (static_cast<double>(bin) + 0.5) / (2 * hop_s);
    }
    /// Number of bins up to the response bandwidth of `output`; `analyse` sets the others to zero.
    Eigen::Index bins_in_bandwidth(Eigen::Index output) const {
        return bins() - bins_above_bandwidth_[output];
    }
    /// Returns the number of frames that do not overlap the rows after this share of the rows; at least one.
    Eigen::Index frames_within(double share) const;

    Eigen::MatrixXd analyse(const Eigen::VectorXd& series) const;
    /// Analyses a series that acts on `output`. Its rows have the weights `MeasuredMotion::weight`, and bins
    /// above the output's `response_bandwidth_hz` are zero.
    Eigen::MatrixXd analyse(const Eigen::VectorXd& series, Eigen::Index output) const;
    /// Applies the transpose of `analyse` for `output`. Returns T values.
    Eigen::VectorXd synthesise(const Eigen::MatrixXd& coefficients, Eigen::Index output) const;
    /// Returns the share of each frame that rows of `output` fill, by the squares of their weights.
    auto filled(Eigen::Index output) const { return filled_.row(output); }

  private:
    /// A segment with one hop of zeros before it and at least one after it, and the position of its frames.
    struct PaddedStretch {
        Stretch rows;
        Eigen::Index first_frame, frames;
    };
    Eigen::VectorXd padded(const Eigen::VectorXd& series, const PaddedStretch& stretch) const;
    Eigen::RowVectorXd filled_by(const Eigen::VectorXd& weight) const;

    LappedTransform transform_;
    std::vector<PaddedStretch> stretches_;
    Eigen::Index frames_ = 0;
    Eigen::MatrixXd weight_; ///< T x m
    Eigen::MatrixXd filled_; ///< m x frames
    /// m: number of the uppermost bins that are set to zero
    Eigen::Vector<Eigen::Index, Eigen::Dynamic> bins_above_bandwidth_;
};

/// Returns the noise variance per bin from its coefficients (bins x frames): the mean square over all frames,
/// weighted by `filled`, and over neighbouring bins. `spent`: degrees of freedom per bin that a fit has used.
/// Upper bins that are all zero get the mean of the others.
Eigen::VectorXd noise_spectrum(const Eigen::MatrixXd& coefficients, const Eigen::RowVectorXd& filled,
                               const Eigen::VectorXd& spent);

/// Returns the local noise scale (bins x frames): the ratio of the noise in each frame and frequency band to
/// its spectrum, 1 on average. It is the scale of Student's t-distribution with few degrees of freedom, which
/// limits the influence of short disturbances. Rows that are not `filled` and bins that are zero have the
/// average scale.
Eigen::MatrixXd local_noise_scale(const Eigen::MatrixXd& coefficients, const Eigen::RowVectorXd& filled,
                                  const Eigen::VectorXd& spectrum);

} // namespace dfdyn::tools
