// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/model/inputs/derivative_rows.hpp"
#include "tools/model/inputs/input_description.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double largest_row = 1e3; // of theta, in units of the pooled deviation

/// R_0 = newest position; the other k-1 rows are free, with length 1. They are learned in the coordinates
/// theta_j = T r_j of the pooled factor T; the length of theta_j is the gain. 1 <= k <= lags + 1.
class FreeRows final : public RowFamily {
  public:
    FreeRows(int lags, int count, const MatrixXd& pooled_factor)
        : lags_(lags), free_(count - 1), factor_(pooled_factor), basis_(inverse_matrix(pooled_factor)) {}

    Bounds bounds() const override {
        const Index count = free_ * (lags_ + 1);
        return {VectorXd::Constant(count, -largest_row), VectorXd::Constant(count, largest_row)};
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

    VectorXd parameters_of(const InputRows& rows, VectorXd others) const override {
        const Index width = factor_.cols();
        const Index count = std::min(rows.gain.size() - 1, others.size() / width);
        for (Index j = 0; j < count; ++j) {
            const VectorXd theta = factor_ * rows.rows.row(j + 1).transpose();
            others.segment(j * width, width) = rows.gain[j + 1] * theta.normalized();
        }
        return others;
    }

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

bool at_most_all_lags(const InputModel& input) { return input.rows_per_joint <= input.lags + 1; }

std::string reduced_type(const InputModel& input) {
    return "DerivativeFreeReduced<" + std::to_string(input.lags) + ", " +
           std::to_string(input.rows_per_joint) + ">";
}

std::unique_ptr<RowFamily> free_rows(const RowShape& shape) {
    return std::make_unique<FreeRows>(shape.lags, shape.rows_per_joint, shape.pooled_factor);
}

} // namespace

const InputDescription& dfr_input() {
    static const InputDescription description{.kind = InputKind::DFR,
                                              .name = "DFR",
                                              .form = InputForm::rows,
                                              .fits = at_most_all_lags,
                                              .firmware_type = reduced_type,
                                              .rows = free_rows,
                                              .motion = MotionSource::own_rows,
                                              .chooses_rows = true,
                                              .starts_from = InputKind::DFSR};
    return description;
}

} // namespace dfdyn::tools
