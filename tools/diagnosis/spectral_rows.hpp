// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/lapped_transform.hpp"
#include "tools/diagnosis/measured_motion.hpp"

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// A series of a recording as lapped-transform coefficients: bins x frames, all stretches one after the
/// other. Rows of output and columns go through the same filter, and their noise is independent with a
/// variance per bin.
class SpectralRows {
  public:
    static constexpr double hop_s = 2; ///< blocks of time; frequencies are 1 / (2 hop_s) apart
    static constexpr double highest_hz = 20;

    explicit SpectralRows(const MeasuredMotion& measured);

    Eigen::Index bins() const noexcept { return transform_.bins(); }
    Eigen::Index frames() const noexcept { return frames_; }
    Eigen::Index count() const noexcept { return bins() * frames_; }
    double frequency_hz(Eigen::Index bin) const noexcept {
        return (static_cast<double>(bin) + 0.5) / (2 * hop_s);
    }
    double frame_start_s(Eigen::Index frame) const { return starts_s_[static_cast<std::size_t>(frame)]; }

    Eigen::MatrixXd analyse(const Eigen::VectorXd& series) const;
    /// The part of a series that the coefficients hold.
    Eigen::VectorXd synthesise(const Eigen::MatrixXd& coefficients) const;

  private:
    LappedTransform transform_;
    std::vector<Stretch> stretches_;
    std::vector<double> starts_s_;
    Eigen::Index rows_ = 0, frames_ = 0;
};

/// Variance of the coefficients of a noise per bin, from its coefficients (bins x frames): the mean square
/// over all frames and neighbouring bins. `spent`: per bin, how many of them a fit has used up.
Eigen::VectorXd noise_spectrum(const Eigen::MatrixXd& coefficients, const Eigen::VectorXd& spent);

/// How much larger than its spectrum a noise is in each frame and frequency band (bins x frames; 1 where it
/// is as usual): the scale of Student's t with few degrees of freedom, so that no short disturbance weighs
/// much.
Eigen::MatrixXd noise_unrest(const Eigen::MatrixXd& coefficients, const Eigen::VectorXd& spectrum);

} // namespace dfdyn::tools
