// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate.hpp"
#include "tools/diagnosis/signals/spectral_rows.hpp"

#include <Eigen/Core>

#include <memory>
#include <utility>
#include <vector>

namespace dfdyn::tools {

/// Sums of squares and products of weighted rows. Column selection needs nothing else.
struct WeightedSums {
    Eigen::MatrixXd gram;   ///< p x p
    Eigen::VectorXd moment; ///< p

    /// Returns the sums of `columns` columns over nothing.
    static WeightedSums zero(Eigen::Index columns) {
        return {Eigen::MatrixXd::Zero(columns, columns), Eigen::VectorXd::Zero(columns)};
    }
};

/// Leave-one-block-out cross-validation: returns half the reduction of a block's sum of squares by the fit to
/// all other blocks. `gram` (p x p, positive definite) and `moment` (p): sums of the other blocks.
double held_out_reduction(const Eigen::MatrixXd& gram, const Eigen::VectorXd& moment,
                          const WeightedSums& block);

/// A column as spectral rows, for each output on which it acts.
struct SpectralColumn {
    struct Part {
        Eigen::Index output = 0;
        Eigen::MatrixXd rows; ///< bins x frames
    };
    std::vector<Part> parts;

    SpectralColumn(const SpectralRows& rows, const EffectColumn& column);
    const Eigen::MatrixXd* on(Eigen::Index output) const; ///< null if it does not act on `output`
};

using SpectralColumnPointer = std::shared_ptr<const SpectralColumn>;

/// Linear regression of the target on the columns, weighted by the noise of each output and frequency.
class EffectRegression {
  public:
    /// `unexplained`: T x m, the residual of the rigid body. Only the first `fitted_frames` are used.
    EffectRegression(const SpectralRows& rows, const Eigen::MatrixXd& unexplained,
                     Eigen::Index fitted_frames);

    Eigen::Index outputs() const noexcept { return static_cast<Eigen::Index>(target_.size()); }
    Eigen::Index columns() const noexcept { return static_cast<Eigen::Index>(columns_.size()); }
    Eigen::Index fitted_frames() const noexcept { return fitted_frames_; }
    const SpectralRows& rows() const noexcept { return rows_; }

    void set_columns(std::vector<SpectralColumnPointer> columns) { columns_ = std::move(columns); }

    /// Sets the noise's spectra (bins x m) and, per output, its local scale (bins x fitted frames). The
    /// weights are the inverses of both.
    void set_noise(Eigen::MatrixXd spectra, const std::vector<Eigen::MatrixXd>& noise_scale);
    const Eigen::MatrixXd& noise() const noexcept { return noise_; }

    WeightedSums weighted_sums() const { return weighted_sums(0, fitted_frames_); }
    /// Returns the sums over `count` frames from `first` on.
    WeightedSums weighted_sums(Eigen::Index first, Eigen::Index count) const;
    /// Returns the sums of `columns`, in their order, over one output and all fitted frames.
    WeightedSums sums_of_output(Eigen::Index output, const std::vector<Eigen::Index>& columns) const;

    /// Returns an output's weights of squares (bins x fitted frames).
    Eigen::MatrixXd weight(Eigen::Index output) const {
        return weight_[static_cast<std::size_t>(output)].array().square();
    }

    /// Returns the unweighted residual of an output (bins x fitted frames) for these coefficients of all
    /// columns.
    Eigen::MatrixXd residual(Eigen::Index output, const Eigen::VectorXd& coefficients) const;

    /// Returns, per bin, the degrees of freedom that a fit of the columns `fitted` uses: the trace of its hat
    /// matrix over an output's fitted rows. `covariance`: of their coefficients, for noise with the assumed
    /// weights. Cost: rows times columns squared.
    Eigen::VectorXd spent(Eigen::Index output, const std::vector<Eigen::Index>& fitted,
                          const Eigen::MatrixXd& covariance) const;

  private:
    /// Adds the sums of `columns` over one output: `sums` has one row for each of them.
    void add_sums(WeightedSums& sums, Eigen::Index output, const std::vector<Eigen::Index>& columns,
                  Eigen::Index first, Eigen::Index count) const;
    Eigen::VectorXd weighted(const Eigen::MatrixXd& rows, Eigen::Index output, Eigen::Index first,
                             Eigen::Index count) const;

    const SpectralRows& rows_;
    Eigen::Index fitted_frames_;
    std::vector<Eigen::MatrixXd> target_; ///< per output, bins x frames
    std::vector<SpectralColumnPointer> columns_;
    Eigen::MatrixXd noise_;
    std::vector<Eigen::MatrixXd> weight_; ///< per output, bins x fitted frames: square roots
};

} // namespace dfdyn::tools
