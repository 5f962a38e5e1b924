// SPDX-License-Identifier: Apache-2.0
#include "tools/model/inputs/derivative_rows.hpp"
#include "tools/model/inputs/input_description.hpp"

#include <array>
#include <cmath>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The position, velocity and acceleration rows of Section V-C of the paper, truncated after lag M. Learned:
/// log alpha_1, log alpha_2, logit beta_1, logit beta_2. The stored R is the paper's matrix with these
/// alphas. Its scale is 1 / standard deviation of the row with alpha = 1. Therefore alpha is the relevance of
/// the input with unit standard deviation, instead of 1/T_s and 1/T_s^2, and the sample period is not needed.
/// lags >= 2.
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

bool three_filters(const InputModel& input) { return input.rows_per_joint == 3 && input.lags >= 2; }

std::string structured_type(const InputModel& input) {
    return "DerivativeFreeStructured<" + std::to_string(input.lags) + ">";
}

std::unique_ptr<RowFamily> structured_rows(const RowShape& shape) {
    return std::make_unique<StructuredRows>(shape.lags);
}

} // namespace

const InputDescription& dfsr_input() {
    static const InputDescription description{.kind = InputKind::DFSR,
                                              .name = "DFSR",
                                              .form = InputForm::rows,
                                              .fits = three_filters,
                                              .firmware_type = structured_type,
                                              .rows = structured_rows,
                                              .motion = MotionSource::own_filters,
                                              .least_lags = 2,
                                              .filters = true,
                                              .cross_validation = true};
    return description;
}

} // namespace dfdyn::tools
