// SPDX-License-Identifier: Apache-2.0
#include "tools/model/inputs/input_description.hpp"

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// R = diag(1, r_1 … r_M), r_j > 0 (a sign would not change the kernel), learned as log r_j. The stored R is
/// this diagonal.
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

bool all_weighted_lags(const InputModel& input) { return input.rows_per_joint == input.lags + 1; }

std::string weighted_type(const InputModel& input) {
    return "DerivativeFreeWeighted<" + std::to_string(input.lags) + ">";
}

std::unique_ptr<RowFamily> diagonal_rows(const RowShape& shape) {
    return std::make_unique<DiagonalRows>(shape.lags);
}

} // namespace

const InputDescription& dfw_input() {
    static const InputDescription description{.kind = InputKind::DFW,
                                              .name = "DFW",
                                              .form = InputForm::window,
                                              .fits = all_weighted_lags,
                                              .firmware_type = weighted_type,
                                              .rows = diagonal_rows,
                                              .motion = MotionSource::polynomial,
                                              .weighted = true};
    return description;
}

} // namespace dfdyn::tools
