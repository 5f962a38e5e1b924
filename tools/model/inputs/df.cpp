// SPDX-License-Identifier: Apache-2.0
#include "tools/model/inputs/input_description.hpp"

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// R = I, nothing to learn.
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

bool all_lags(const InputModel& input) { return input.rows_per_joint == input.lags + 1; }

std::string window_type(const InputModel& input) {
    return "DerivativeFree<" + std::to_string(input.lags) + ">";
}

std::unique_ptr<RowFamily> identity_rows(const RowShape& shape) {
    return std::make_unique<IdentityRows>(shape.lags);
}

} // namespace

const InputDescription& df_input() {
    static const InputDescription description{.kind = InputKind::DF,
                                              .name = "DF",
                                              .form = InputForm::window,
                                              .fits = all_lags,
                                              .firmware_type = window_type,
                                              .rows = identity_rows,
                                              .motion = MotionSource::polynomial,
                                              .cross_validation = true};
    return description;
}

} // namespace dfdyn::tools
