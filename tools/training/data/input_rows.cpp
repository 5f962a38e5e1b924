// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/input_rows.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/training/data/derivative_rows.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double gain_most = 1e3;
constexpr double gain_least = 1e-3;
constexpr double perturbation = 0.5;

class IdentityRows final : public RowFamily {
  public:
    explicit IdentityRows(int lags) : width_(lags + 1) {}
    Bounds bounds() const override { return {VectorXd(0), VectorXd(0)}; }
    InputRows evaluate(const VectorXd& /*parameters*/) const override {
        return {MatrixXd::Identity(width_, width_), VectorXd::Ones(width_)};
    }
    VectorXd pull_back(const VectorXd& /*parameters*/, const InputRowsGradient& /*gradient*/) const override {
        return VectorXd(0);
    }
    VectorXd start(int /*index*/, NormalSource& /*random*/) const override { return VectorXd(0); }
    VectorXd stored_gain(const InputRows& rows) const override { return rows.gain; }

  private:
    Index width_;
};

class DiagonalRows final : public RowFamily {
  public:
    explicit DiagonalRows(int lags) : width_(lags + 1) {}
    Bounds bounds() const override { return log_gain_bounds(width_ - 1); }
    InputRows evaluate(const VectorXd& parameters) const override {
        VectorXd gain = VectorXd::Ones(width_);
        gain.tail(width_ - 1) = parameters.array().exp();
        return {MatrixXd::Identity(width_, width_), gain};
    }
    VectorXd pull_back(const VectorXd& parameters, const InputRowsGradient& gradient) const override {
        return gradient.gain.tail(width_ - 1).cwiseProduct(parameters.array().exp().matrix());
    }
    VectorXd start(int index, NormalSource& random) const override {
        return perturbed(VectorXd::Zero(width_ - 1), index, 1, random);
    }
    VectorXd stored_gain(const InputRows& rows) const override { return rows.gain; }

  private:
    Index width_;
};

class StructuredRows final : public RowFamily {
  public:
    explicit StructuredRows(int lags) : lags_(lags) {}

    Bounds bounds() const override {
        Bounds bounds{VectorXd(4), VectorXd(4)};
        const Bounds gains = log_gain_bounds(2);
        bounds.lower << gains.lower, -logit_most, -logit_most;
        bounds.upper << gains.upper, logit_most, logit_most;
        return bounds;
    }

    InputRows evaluate(const VectorXd& parameters) const override {
        InputRows rows{MatrixXd::Zero(3, lags_ + 1), VectorXd(3)};
        rows.rows(0, 0) = 1;
        rows.rows.row(1) = filtered_velocity_row(logistic(parameters[2]), lags_).transpose();
        rows.rows.row(2) = filtered_acceleration_row(logistic(parameters[3]), lags_).transpose();
        rows.gain << 1, std::exp(parameters[0]), std::exp(parameters[1]);
        return rows;
    }

    VectorXd pull_back(const VectorXd& parameters, const InputRowsGradient& gradient) const override {
        const double beta_1 = logistic(parameters[2]);
        const double beta_2 = logistic(parameters[3]);
        VectorXd result(4);
        result[0] = gradient.gain[1] * std::exp(parameters[0]);
        result[1] = gradient.gain[2] * std::exp(parameters[1]);
        result[2] =
            gradient.rows.row(1).dot(filtered_velocity_row_slope(beta_1, lags_)) * beta_1 * (1 - beta_1);
        result[3] =
            gradient.rows.row(2).dot(filtered_acceleration_row_slope(beta_2, lags_)) * beta_2 * (1 - beta_2);
        return result;
    }

    VectorXd start(int index, NormalSource& random) const override {
        constexpr std::array<double, 3> beta_starts{0.4, 0.75, 0.1};
        const double logit = -std::log(1 / beta_starts[static_cast<std::size_t>(index) % 3] - 1);
        VectorXd parameters(4);
        parameters << 0, 0, logit, logit;
        return perturbed(parameters, index, 3, random);
    }

    VectorXd stored_gain(const InputRows& rows) const override { return rows.gain; }

    void describe(const VectorXd& parameters, InputModel& model) const override {
        model.alpha = {std::exp(parameters[0]), std::exp(parameters[1])};
        model.beta = {logistic(parameters[2]), logistic(parameters[3])};
    }

  private:
    static constexpr double logit_most = 6; // beta between 0.0025 and 0.9975
    static double logistic(double value) { return 1 / (1 + std::exp(-value)); }

    int lags_;
};

class FreeRows final : public RowFamily {
  public:
    FreeRows(int lags, int count, const MatrixXd& pooled_factor)
        : lags_(lags), free_(count - 1), factor_(pooled_factor), basis_(inverse_matrix(pooled_factor)) {}

    Bounds bounds() const override {
        const Index count = free_ * (lags_ + 1);
        return {VectorXd::Constant(count, -gain_most), VectorXd::Constant(count, gain_most)};
    }

    InputRows evaluate(const VectorXd& parameters) const override {
        InputRows rows{MatrixXd::Zero(free_ + 1, lags_ + 1), VectorXd::Ones(free_ + 1)};
        rows.rows(0, 0) = 1;
        for (Index j = 0; j < free_; ++j) {
            const VectorXd theta = parameters.segment(j * (lags_ + 1), lags_ + 1);
            rows.rows.row(j + 1) = (basis_ * theta).normalized().transpose();
            rows.gain[j + 1] = theta.norm();
        }
        return rows;
    }

    VectorXd pull_back(const VectorXd& parameters, const InputRowsGradient& gradient) const override {
        VectorXd result(parameters.size());
        for (Index j = 0; j < free_; ++j) {
            const VectorXd theta = parameters.segment(j * (lags_ + 1), lags_ + 1);
            const VectorXd row = basis_ * theta;
            const VectorXd unit = row.normalized();
            const VectorXd along = gradient.rows.row(j + 1).transpose();
            const VectorXd across = (along - unit * unit.dot(along)) / row.norm();
            result.segment(j * (lags_ + 1), lags_ + 1) =
                basis_.transpose() * across + gradient.gain[j + 1] * theta.normalized();
        }
        return result;
    }

    /// Derivatives of order 1 … k-1, by start: smooth polynomial fit, the paper's low-pass filters, raw
    /// polynomial, then perturbed ones.
    VectorXd start(int index, NormalSource& random) const override {
        VectorXd parameters(free_ * (lags_ + 1));
        for (Index j = 0; j < free_; ++j) {
            const VectorXd theta = factor_ * start_row(index % 3, static_cast<int>(j) + 1);
            parameters.segment(j * (lags_ + 1), lags_ + 1) = theta.normalized();
        }
        return perturbed(parameters, index, 3, random);
    }

    VectorXd stored_gain(const InputRows& rows) const override { return VectorXd::Ones(rows.gain.size()); }

  private:
    /// Row j >= 1 of the paper's filters; for k >= 4 there are a fast and a slow velocity row.
    VectorXd filtered_row(int row) const {
        if (row == 1) {
            return filtered_velocity_row(0.4, lags_);
        }
        return row == 2 && free_ > 2 ? filtered_velocity_row(0.85, lags_)
                                     : filtered_acceleration_row(free_ > 2 ? 0.8 : 0.4, lags_);
    }

    VectorXd start_row(int kind, int order) const {
        if (kind == 1 && order <= (free_ > 2 ? 3 : 2)) {
            return filtered_row(order);
        }
        return polynomial_derivative_row(order, std::min(lags_, kind == 2 ? order + 2 : order), lags_);
    }

    int lags_;
    Index free_;
    MatrixXd factor_; // theta = T r
    MatrixXd basis_;  // r = T^-1 theta
};

} // namespace

Bounds log_gain_bounds(Index count) {
    return {VectorXd::Constant(count, std::log(gain_least)), VectorXd::Constant(count, std::log(gain_most))};
}

VectorXd perturbed(const VectorXd& base, int index, int fixed, NormalSource& random) {
    return index < fixed ? base : VectorXd(base + perturbation * random.matrix(base.size(), 1));
}

std::unique_ptr<RowFamily> identity_rows(int lags) { return std::make_unique<IdentityRows>(lags); }

std::unique_ptr<RowFamily> diagonal_rows(int lags) { return std::make_unique<DiagonalRows>(lags); }

std::unique_ptr<RowFamily> free_rows(int lags, int count, const MatrixXd& pooled_factor) {
    return std::make_unique<FreeRows>(lags, count, pooled_factor);
}

VectorXd free_parameters(const InputRows& rows, const MatrixXd& pooled_factor, VectorXd others) {
    const Index width = pooled_factor.cols();
    const Index count = std::min(rows.gain.size() - 1, others.size() / width);
    for (Index j = 0; j < count; ++j) {
        const VectorXd theta = pooled_factor * rows.rows.row(j + 1).transpose();
        others.segment(j * width, width) = rows.gain[j + 1] * theta.normalized();
    }
    return others;
}

std::unique_ptr<RowFamily> structured_rows(int lags) { return std::make_unique<StructuredRows>(lags); }

} // namespace dfdyn::tools
