// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/motion.hpp"

#include "tools/model/inputs/derivative_rows.hpp"

#include <Eigen/QR>

#include <array>
#include <cmath>
#include <utility>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double logit_most = 6;         // beta between 0.0025 and 0.9975
constexpr double beta_start = 0.4;       // the filters of DFR's starts
constexpr double log_factor_range = 4.6; // a factor of 1/100 to 100
constexpr double log_room = 0.7;         // a factor of 2
constexpr double change_most = 10;       // of a free row, in lengths of its start
constexpr double alike_least = 0.05;     // least correlation of a row with the derivative it starts from

Bounds no_bounds() { return {VectorXd(0), VectorXd(0)}; }

class GivenMotion final : public LearnedMotion {
  public:
    GivenMotion(const TrainingData& data, const RowList& rows)
        : samples_{data.positions(rows, Eigen::all), data.velocities(rows, Eigen::all),
                   data.accelerations(rows, Eigen::all)} {}

    Bounds bounds() const override { return no_bounds(); }
    VectorXd start(const VectorXd& /*input*/) const override { return VectorXd(0); }
    bool learns() const override { return false; }
    MotionSamples evaluate(const VectorXd& /*parameters*/) const override { return samples_; }
    VectorXd pull_back(const VectorXd& parameters, const MotionGradient& /*gradient*/) const override {
        return VectorXd::Zero(parameters.size());
    }

  private:
    MotionSamples samples_;
};

class LagMotion final : public LearnedMotion {
  public:
    LagMotion(const MatrixXd& positions, const RowList& rows, int lags,
              std::unique_ptr<MotionRows> motion_rows)
        : positions_(positions(rows, Eigen::all)), windows_(lag_windows(positions, rows, lags)),
          width_(lags + 1), rows_(std::move(motion_rows)) {}

    Bounds bounds() const override { return rows_->bounds(); }
    VectorXd start(const VectorXd& input) const override { return rows_->start(input); }
    bool learns() const override { return rows_->learns(); }

    MotionSamples evaluate(const VectorXd& parameters) const override {
        const MatrixXd rows = rows_->evaluate(parameters);
        MotionSamples samples{positions_, MatrixXd(positions_.rows(), positions_.cols()),
                              MatrixXd(positions_.rows(), positions_.cols())};
        for (Index joint = 0; joint < positions_.cols(); ++joint) {
            samples.velocities.col(joint) = window_of(joint) * rows.row(0).transpose();
            samples.accelerations.col(joint) = window_of(joint) * rows.row(1).transpose();
        }
        return samples;
    }

    VectorXd pull_back(const VectorXd& parameters, const MotionGradient& gradient) const override {
        MatrixXd rows = MatrixXd::Zero(2, width_);
        for (Index joint = 0; joint < positions_.cols(); ++joint) {
            rows.row(0) += gradient.velocities.col(joint).transpose() * window_of(joint);
            rows.row(1) += gradient.accelerations.col(joint).transpose() * window_of(joint);
        }
        return rows_->pull_back(parameters, rows);
    }

  private:
    Eigen::Block<const MatrixXd, Eigen::Dynamic, Eigen::Dynamic, true> window_of(Index joint) const {
        return windows_.middleCols(joint * width_, width_);
    }

    MatrixXd positions_;
    MatrixXd windows_;
    Index width_;
    std::unique_ptr<MotionRows> rows_;
};

/// Rows of order 1 and 2 in units of the sample period, divided by its powers.
MatrixXd physical_rows(const VectorXd& velocity, const VectorXd& acceleration, double sample_period) {
    MatrixXd rows(2, velocity.size());
    rows.row(0) = velocity.transpose() / sample_period;
    rows.row(1) = acceleration.transpose() / (sample_period * sample_period);
    return rows;
}

MatrixXd polynomial_rows(int lags, double sample_period) {
    constexpr int degree = 2;
    return physical_rows(unit_polynomial_derivative_row(1, degree, lags),
                         unit_polynomial_derivative_row(2, degree, lags), sample_period);
}

class PolynomialMotion final : public MotionRows {
  public:
    PolynomialMotion(int lags, double sample_period) : rows_(polynomial_rows(lags, sample_period)) {}

    Bounds bounds() const override { return no_bounds(); }
    VectorXd start(const VectorXd& /*input*/) const override { return VectorXd(0); }
    bool learns() const override { return false; }
    MatrixXd evaluate(const VectorXd& /*parameters*/) const override { return rows_; }
    VectorXd pull_back(const VectorXd& parameters, const MatrixXd& /*gradient*/) const override {
        return VectorXd::Zero(parameters.size());
    }

  private:
    MatrixXd rows_;
};

/// The filters of DFSR in physical units.
MatrixXd difference_rows(double beta_1, double beta_2, int lags, double sample_period) {
    return physical_rows(mean_difference_row(1, beta_1, lags), mean_difference_row(2, beta_2, lags),
                         sample_period);
}

class DifferenceMotion final : public MotionRows {
  public:
    DifferenceMotion(int lags, double sample_period, Index first, bool own)
        : lags_(lags), period_(sample_period), first_(first), own_(own) {}

    Bounds bounds() const override {
        return own_ ? Bounds{VectorXd::Constant(2, -logit_most), VectorXd::Constant(2, logit_most)}
                    : no_bounds();
    }

    VectorXd start(const VectorXd& /*input*/) const override {
        return VectorXd::Constant(own_ ? 2 : 0, -std::log(1 / beta_start - 1));
    }

    bool learns() const override { return true; }

    MatrixXd evaluate(const VectorXd& parameters) const override {
        return difference_rows(beta(parameters, 0), beta(parameters, 1), lags_, period_);
    }

    VectorXd pull_back(const VectorXd& parameters, const MatrixXd& gradient) const override {
        const MatrixXd slopes =
            physical_rows(mean_difference_row_slope(1, beta(parameters, 0), lags_),
                          mean_difference_row_slope(2, beta(parameters, 1), lags_), period_);
        VectorXd result = VectorXd::Zero(parameters.size());
        for (Index order = 0; order < 2; ++order) {
            const double at = beta(parameters, order);
            result[first_ + order] = gradient.row(order).dot(slopes.row(order)) * at * (1 - at);
        }
        return result;
    }

  private:
    double beta(const VectorXd& parameters, Index order) const {
        return 1 / (1 + std::exp(-parameters[first_ + order]));
    }

    int lags_;
    double period_;
    Index first_;
    bool own_;
};

/// Returns an orthonormal basis, in columns, of the rows that are 0 for all polynomials of less than
/// `degree`.
MatrixXd rows_without_polynomials(Index degree, int lags) {
    MatrixXd polynomials(lags + 1, degree);
    for (Index power = 0; power < degree; ++power) {
        polynomials.col(power) = VectorXd::LinSpaced(lags + 1, 0, 1).array().pow(static_cast<double>(power));
    }
    const MatrixXd basis = polynomials.householderQr().householderQ();
    return basis.rightCols(lags + 1 - degree);
}

class FreeMotion final : public MotionRows {
  public:
    FreeMotion(int lags, double sample_period, Index inputs)
        : inputs_(inputs), start_(difference_rows(beta_start, beta_start, lags, sample_period)),
          changes_{start_.row(0).norm() * rows_without_polynomials(2, lags),
                   start_.row(1).norm() * rows_without_polynomials(3, lags)} {}

    Bounds bounds() const override {
        return {VectorXd::Constant(count(), -change_most), VectorXd::Constant(count(), change_most)};
    }

    VectorXd start(const VectorXd& /*input*/) const override { return VectorXd::Zero(count()); }
    bool learns() const override { return true; }

    MatrixXd evaluate(const VectorXd& parameters) const override {
        MatrixXd rows = start_;
        rows.row(0) += (changes_[0] * parameters.segment(inputs_, of(0))).transpose();
        rows.row(1) += (changes_[1] * parameters.segment(inputs_ + of(0), of(1))).transpose();
        return rows;
    }

    VectorXd pull_back(const VectorXd& parameters, const MatrixXd& gradient) const override {
        VectorXd result = VectorXd::Zero(parameters.size());
        result.segment(inputs_, of(0)) = changes_[0].transpose() * gradient.row(0).transpose();
        result.segment(inputs_ + of(0), of(1)) = changes_[1].transpose() * gradient.row(1).transpose();
        return result;
    }

  private:
    Index of(std::size_t row) const { return changes_[row].cols(); }
    Index count() const { return of(0) + of(1); }

    Index inputs_;
    MatrixXd start_;
    std::array<MatrixXd, 2> changes_; ///< columns: changes of the two rows that keep their responses
};

class ScaledMotion final : public MotionRows {
  public:
    ScaledMotion(std::unique_ptr<RowFamily> family, int lags, double sample_period, MatrixXd pooled_factor)
        : family_(std::move(family)), inputs_(family_->bounds().lower.size()),
          polynomial_(polynomial_rows(lags, sample_period)), factor_(std::move(pooled_factor)),
          log_most_(difference_rows(0, 0, lags, sample_period).rowwise().norm().array().log() + log_room) {}

    Bounds bounds() const override {
        const VectorXd typical = polynomial_.rowwise().norm().array().log();
        return {typical.array() - log_factor_range,
                (typical.array() + log_factor_range).max(log_most_.array())};
    }

    VectorXd start(const VectorXd& input) const override {
        return log_factors(family_->evaluate(input).rows.middleRows(1, 2), polynomial_, factor_);
    }

    bool learns() const override { return true; }

    MatrixXd evaluate(const VectorXd& parameters) const override {
        const MatrixXd rows = family_->evaluate(parameters.head(inputs_)).rows.middleRows(1, 2);
        return factors(parameters).asDiagonal() * rows;
    }

    VectorXd pull_back(const VectorXd& parameters, const MatrixXd& gradient) const override {
        const InputRows rows = family_->evaluate(parameters.head(inputs_));
        InputRowsGradient slopes{MatrixXd::Zero(rows.rows.rows(), rows.rows.cols()),
                                 VectorXd::Zero(rows.gain.size())};
        slopes.rows.middleRows(1, 2) = factors(parameters).asDiagonal() * gradient;
        VectorXd result(parameters.size());
        result.head(inputs_) = family_->pull_back(parameters.head(inputs_), slopes);
        // gradient with respect to the logarithms
        result.segment(inputs_, 2) = evaluate(parameters).cwiseProduct(gradient).rowwise().sum();
        return result;
    }

  private:
    VectorXd factors(const VectorXd& parameters) const {
        return parameters.segment(inputs_, 2).array().exp();
    }

    std::unique_ptr<RowFamily> family_;
    Index inputs_;
    MatrixXd polynomial_;
    MatrixXd factor_;
    VectorXd log_most_; // no longer than the filters of DFSR
};

} // namespace

std::unique_ptr<LearnedMotion> given_motion(const TrainingData& data, const RowList& rows) {
    return std::make_unique<GivenMotion>(data, rows);
}

std::unique_ptr<LearnedMotion> lag_motion(const MatrixXd& positions, const RowList& rows, int lags,
                                          std::unique_ptr<MotionRows> motion_rows) {
    return std::make_unique<LagMotion>(positions, rows, lags, std::move(motion_rows));
}

std::unique_ptr<MotionRows> polynomial_motion(int lags, double sample_period) {
    return std::make_unique<PolynomialMotion>(lags, sample_period);
}

std::unique_ptr<MotionRows> difference_motion(int lags, double sample_period, Index first, bool own) {
    return std::make_unique<DifferenceMotion>(lags, sample_period, first, own);
}

std::unique_ptr<MotionRows> free_motion(int lags, double sample_period, Index inputs) {
    return std::make_unique<FreeMotion>(lags, sample_period, inputs);
}

VectorXd log_factors(const MatrixXd& rows, const MatrixXd& wanted, const MatrixXd& pooled_factor) {
    VectorXd logarithms(rows.rows());
    for (Index order = 0; order < rows.rows(); ++order) {
        const VectorXd here = pooled_factor * rows.row(order).transpose();
        const VectorXd there = pooled_factor * wanted.row(order).transpose();
        const bool alike = here.dot(there) > alike_least * here.norm() * there.norm();
        logarithms[order] = std::log(alike ? here.dot(there) / here.squaredNorm()
                                           : wanted.row(order).norm() / rows.row(order).norm());
    }
    return logarithms;
}

std::unique_ptr<MotionRows> scaled_motion(std::unique_ptr<RowFamily> family, int lags, double sample_period,
                                          const MatrixXd& pooled_factor) {
    return std::make_unique<ScaledMotion>(std::move(family), lags, sample_period, pooled_factor);
}

} // namespace dfdyn::tools
