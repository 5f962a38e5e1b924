// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/input_map.hpp"

#include "tools/base/numerics/to_vector.hpp"

#include <cmath>
#include <utility>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

double inverse_or_one(double deviation) { return deviation > 0 ? 1 / deviation : 1; }

class LagInput final : public InputMap {
  public:
    LagInput(const MatrixXd& positions, const RowList& rows, LagSpread spread,
             std::unique_ptr<RowFamily> family)
        : windows_(lag_windows(positions, rows, spread.lags())), spread_(std::move(spread)),
          family_(std::move(family)) {
        windows_.rowwise() -= windows_.colwise().mean().eval();
    }

    Bounds bounds() const override { return family_->bounds(); }
    VectorXd start(int index, NormalSource& random) const override { return family_->start(index, random); }

    MatrixXd inputs(const VectorXd& parameters) const override {
        const InputRows rows = family_->evaluate(parameters);
        const Index count = rows.gain.size();
        MatrixXd inputs(windows_.rows(), spread_.joints() * count);
        for (Index joint = 0; joint < spread_.joints(); ++joint) {
            const VectorXd scale = rows.gain.cwiseProduct(inverse_deviations(joint, rows.rows));
            inputs.middleCols(joint * count, count).noalias() =
                windows_of(joint) * (scale.asDiagonal() * rows.rows).transpose();
        }
        return inputs;
    }

    VectorXd pull_back(const VectorXd& parameters, const MatrixXd& input_gradient) const override {
        const InputRows rows = family_->evaluate(parameters);
        const Index count = rows.gain.size();
        InputRowsGradient gradient{MatrixXd::Zero(count, rows.rows.cols()), VectorXd::Zero(count)};
        for (Index joint = 0; joint < spread_.joints(); ++joint) {
            const MatrixXd unscaled =
                input_gradient.middleCols(joint * count, count).transpose() * windows_of(joint);
            for (Index j = 0; j < count; ++j) {
                add_gradient(joint, j, rows, unscaled.row(j).transpose(), gradient);
            }
        }
        return family_->pull_back(parameters, gradient);
    }

    InputModel model(const VectorXd& parameters) const override {
        const InputRows rows = family_->evaluate(parameters);
        const VectorXd stored_gain = family_->stored_gain(rows);
        RowMajor scale(spread_.joints(), rows.gain.size());
        for (Index joint = 0; joint < spread_.joints(); ++joint) {
            scale.row(joint) = rows.gain.cwiseQuotient(stored_gain)
                                   .cwiseProduct(inverse_deviations(joint, rows.rows))
                                   .transpose();
        }
        InputModel model;
        model.rows_per_joint = static_cast<int>(rows.gain.size());
        model.rows = to_vector(RowMajor(stored_gain.asDiagonal() * rows.rows));
        model.scale = to_vector(scale);
        family_->describe(parameters, model);
        return model;
    }

  private:
    Eigen::Block<const MatrixXd, Eigen::Dynamic, Eigen::Dynamic, true> windows_of(Index joint) const {
        return windows_.middleCols(joint * (spread_.lags() + 1), spread_.lags() + 1);
    }

    VectorXd inverse_deviations(Index joint, const MatrixXd& rows) const {
        VectorXd result(rows.rows());
        for (Index j = 0; j < rows.rows(); ++j) {
            result[j] = inverse_or_one(spread_.deviation(joint, rows.row(j).transpose()));
        }
        return result;
    }

    /// `unscaled` = sum over the samples of (gradient of xi_(i,j)) q_i(t^-); xi = gain r'q / s(r), ds/dr =
    /// T'T r / s.
    void add_gradient(Index joint, Index j, const InputRows& rows, const VectorXd& unscaled,
                      InputRowsGradient& gradient) const {
        const VectorXd row = rows.rows.row(j).transpose();
        const double deviation = spread_.deviation(joint, row);
        const double inverse = inverse_or_one(deviation);
        const double sum = inverse * row.dot(unscaled);
        gradient.gain[j] += sum;
        gradient.rows.row(j) += rows.gain[j] * inverse * unscaled.transpose();
        if (deviation > 0) {
            gradient.rows.row(j) -=
                rows.gain[j] * sum * inverse * spread_.deviation_gradient(joint, row).transpose();
        }
    }

    MatrixXd windows_; // N x n(M+1), each column without its mean
    LagSpread spread_;
    std::unique_ptr<RowFamily> family_;
};

constexpr Index derivatives = 3; // position, velocity, acceleration

/// rows x 3n: joint by joint position, velocity, acceleration.
MatrixXd derivative_columns(const TrainingData& data, const RowList& rows) {
    const Index joints = data.positions.cols();
    MatrixXd columns(static_cast<Index>(rows.size()), joints * derivatives);
    for (Index t = 0; t < columns.rows(); ++t) {
        for (Index joint = 0; joint < joints; ++joint) {
            const Index row = rows[static_cast<std::size_t>(t)];
            columns.row(t).segment(joint * derivatives, derivatives) << data.positions(row, joint),
                data.velocities(row, joint), data.accelerations(row, joint);
        }
    }
    return columns;
}

VectorXd inverse_column_deviations(const MatrixXd& columns, const LagSpread& spread) {
    constexpr double rounding_fraction = 1e-12;
    VectorXd result(columns.cols());
    const VectorXd position = VectorXd::Unit(spread.lags() + 1, 0);
    for (Index c = 0; c < columns.cols(); ++c) {
        const double size = columns.col(c).cwiseAbs().maxCoeff();
        const double deviation =
            (columns.col(c).array() - columns.col(c).mean()).matrix().norm() / std::sqrt(columns.rows());
        const bool held = spread.deviation(c / derivatives, position) == 0;
        result[c] = inverse_or_one(held || deviation <= rounding_fraction * size ? 0 : deviation);
    }
    return result;
}

class DerivativeInput final : public InputMap {
  public:
    DerivativeInput(const TrainingData& data, const RowList& rows, const RowList& scale_rows,
                    const LagSpread& spread, bool relevance)
        : columns_(derivative_columns(data, rows)), gains_(relevance ? derivatives - 1 : 0),
          inverse_deviations_(inverse_column_deviations(derivative_columns(data, scale_rows), spread)) {
        columns_.rowwise() -= columns_.colwise().mean().eval();
    }

    Bounds bounds() const override { return log_gain_bounds(gains_); }

    VectorXd start(int index, NormalSource& random) const override {
        return perturbed(VectorXd::Zero(gains_), index, 1, random);
    }

    MatrixXd inputs(const VectorXd& parameters) const override {
        return columns_ * scale(parameters).asDiagonal();
    }

    VectorXd pull_back(const VectorXd& parameters, const MatrixXd& input_gradient) const override {
        const VectorXd per_column =
            inputs(parameters).cwiseProduct(input_gradient).colwise().sum().transpose();
        VectorXd result = VectorXd::Zero(gains_);
        for (Index c = 0; c < per_column.size(); ++c) {
            if (has_gain(c)) {
                result[c % derivatives - 1] += per_column[c];
            }
        }
        return result;
    }

    InputModel model(const VectorXd& parameters) const override {
        InputModel model;
        model.rows_per_joint = derivatives;
        model.scale = to_vector(scale(parameters));
        return model;
    }

  private:
    bool has_gain(Index column) const { return gains_ > 0 && column % derivatives > 0; }

    VectorXd scale(const VectorXd& parameters) const {
        VectorXd scale = inverse_deviations_;
        for (Index c = 0; c < scale.size(); ++c) {
            if (has_gain(c)) {
                scale[c] *= std::exp(parameters[c % derivatives - 1]);
            }
        }
        return scale;
    }

    MatrixXd columns_; // N x 3n, each column without its mean
    Index gains_;      // learned gains
    VectorXd inverse_deviations_;
};

} // namespace

std::unique_ptr<InputMap> lag_input(const MatrixXd& positions, const RowList& rows, LagSpread spread,
                                    std::unique_ptr<RowFamily> family) {
    return std::make_unique<LagInput>(positions, rows, std::move(spread), std::move(family));
}

std::unique_ptr<InputMap> derivative_input(const TrainingData& data, const RowList& rows,
                                           const RowList& scale_rows, const LagSpread& spread,
                                           bool relevance) {
    return std::make_unique<DerivativeInput>(data, rows, scale_rows, spread, relevance);
}

MatrixXd stored_inputs(const InputModel& model, const TrainingData& data, const RowList& rows) {
    const Eigen::Map<const VectorXd> scale(model.scale.data(), static_cast<Index>(model.scale.size()));
    if (model.rows.empty()) {
        return derivative_columns(data, rows) * scale.asDiagonal();
    }
    const Eigen::Map<const RowMajor> matrix(model.rows.data(), model.rows_per_joint, model.lags + 1);
    const MatrixXd windows = lag_windows(data.positions, rows, model.lags);
    MatrixXd inputs(windows.rows(), scale.size());
    for (Index joint = 0; joint < data.positions.cols(); ++joint) {
        inputs.middleCols(joint * matrix.rows(), matrix.rows()) =
            windows.middleCols(joint * matrix.cols(), matrix.cols()) * matrix.transpose();
    }
    return inputs * scale.asDiagonal();
}

} // namespace dfdyn::tools
