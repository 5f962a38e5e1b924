// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/signals/lapped_transform.hpp"
#include "tools/diagnosis/signals/measured_motion.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// A series of a recording as lapped-transform coefficients: bins x frames, all stretches one after the
/// other, each with nothing before and behind it, so that all its rows count. Rows of output and columns go
/// through the same filter, and their noise is independent with a variance per bin.
class SpectralRows {
  public:
    static constexpr double hop_s = 2; ///< blocks of time; frequencies are 1 / (2 hop_s) apart
    static constexpr double highest_hz = 20;

    explicit SpectralRows(const MeasuredMotion& measured);

    Eigen::Index bins() const noexcept { return transform_.bins(); }
    Eigen::Index frames() const noexcept { return frames_; }
    Eigen::Index rows() const noexcept { return weight_.rows(); }
    Eigen::Index count() const noexcept { return bins() * frames_; }
    double frequency_hz(Eigen::Index bin) const noexcept {
        return (static_cast<double>(bin) + 0.5) / (2 * hop_s);
    }
    /// How many frames see nothing of what comes behind this share of the rows; at least one.
    Eigen::Index frames_within(double share) const;

    Eigen::MatrixXd analyse(const Eigen::VectorXd& series) const;
    /// Of what acts on `output`: its rows count as much as `MeasuredMotion::weight` says, and frequencies
    /// above its `answered_hz` not at all: zeros.
    Eigen::MatrixXd analyse(const Eigen::VectorXd& series, Eigen::Index output) const;
    /// The transpose of `analyse` for `output`: T.
    Eigen::VectorXd synthesise(const Eigen::MatrixXd& coefficients, Eigen::Index output) const;
    /// Per frame, the share of it that rows of `output` fill, by the squares of their weights.
    auto filled(Eigen::Index output) const { return filled_.row(output); }

  private:
    /// A stretch with a hop of nothing before it and at least one behind; where its frames are.
    struct PaddedStretch {
        Stretch rows;
        Eigen::Index first_frame, frames;
    };
    Eigen::VectorXd padded(const Eigen::VectorXd& series, const PaddedStretch& stretch) const;
    Eigen::RowVectorXd filled_by(const Eigen::VectorXd& weight) const;

    LappedTransform transform_;
    std::vector<PaddedStretch> stretches_;
    Eigen::Index frames_ = 0;
    Eigen::MatrixXd weight_;                                      ///< T x m
    Eigen::MatrixXd filled_;                                      ///< m x frames
    Eigen::Vector<Eigen::Index, Eigen::Dynamic> unanswered_bins_; ///< m: of the uppermost
};

/// Variance of the coefficients of a noise per bin, from its coefficients (bins x frames): the mean square
/// over all frames, as far as they are `filled`, and neighbouring bins. `spent`: per bin, how many of them a
/// fit has used up. Of the upper bins that are zero: that of the others' mean.
Eigen::VectorXd noise_spectrum(const Eigen::MatrixXd& coefficients, const Eigen::RowVectorXd& filled,
                               const Eigen::VectorXd& spent);

/// How much larger than its spectrum a noise is in each frame and frequency band (bins x frames; 1 where it
/// is as usual): the scale of Student's t with few degrees of freedom, so that no short disturbance weighs
/// much. What is not `filled`, or zero, counts as usual.
Eigen::MatrixXd noise_unrest(const Eigen::MatrixXd& coefficients, const Eigen::RowVectorXd& filled,
                             const Eigen::VectorXd& spectrum);

} // namespace dfdyn::tools
