// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/effect_regression.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <numeric>

namespace dfdyn::tools {

double held_out_reduction(const Eigen::MatrixXd& gram, const Eigen::VectorXd& moment,
                          const WeightedSums& block) {
    const Eigen::VectorXd fit = gram.ldlt().solve(moment);
    return fit.dot(block.moment) - 0.5 * fit.dot(block.gram * fit);
}

SpectralColumn::SpectralColumn(const SpectralRows& rows, const EffectColumn& column) {
    for (const EffectColumn::Part& part : column.parts) {
        if (!part.series.isZero(0)) {
            parts.push_back({part.output, rows.analyse(part.series, part.output)});
        }
    }
}

const Eigen::MatrixXd* SpectralColumn::on(Eigen::Index output) const {
    const auto found = std::ranges::find(parts, output, &Part::output);
    return found == parts.end() ? nullptr : &found->rows;
}

EffectRegression::EffectRegression(const SpectralRows& rows, const Eigen::MatrixXd& unexplained,
                                   Eigen::Index fitted_frames)
    : rows_(rows), fitted_frames_(fitted_frames),
      noise_(Eigen::MatrixXd::Ones(rows.bins(), unexplained.cols())) {
    for (Eigen::Index output = 0; output < unexplained.cols(); ++output) {
        target_.push_back(rows.analyse(unexplained.col(output), output));
        weight_.emplace_back(Eigen::MatrixXd::Ones(rows.bins(), fitted_frames));
    }
}

void EffectRegression::set_noise(Eigen::MatrixXd spectra, const std::vector<Eigen::MatrixXd>& noise_scale) {
    noise_ = std::move(spectra);
    weight_.clear();
    for (Eigen::Index output = 0; output < outputs(); ++output) {
        const Eigen::MatrixXd variance =
            noise_.col(output).asDiagonal() * noise_scale[static_cast<std::size_t>(output)];
        weight_.emplace_back(variance.cwiseSqrt().cwiseInverse());
    }
}

Eigen::VectorXd EffectRegression::weighted(const Eigen::MatrixXd& rows, Eigen::Index output,
                                           Eigen::Index first, Eigen::Index count) const {
    const Eigen::MatrixXd result = weight_[static_cast<std::size_t>(output)]
                                       .middleCols(first, count)
                                       .cwiseProduct(rows.middleCols(first, count));
    return result.reshaped();
}

void EffectRegression::add_sums(WeightedSums& sums, Eigen::Index output,
                                const std::vector<Eigen::Index>& columns, Eigen::Index first,
                                Eigen::Index count) const {
    std::vector<Eigen::Index> acting; // positions in `columns`
    std::vector<const Eigen::MatrixXd*> rows;
    for (std::size_t i = 0; i < columns.size(); ++i) {
        if (const auto* const on = columns_[static_cast<std::size_t>(columns[i])]->on(output)) {
            acting.push_back(static_cast<Eigen::Index>(i));
            rows.push_back(on);
        }
    }
    const auto size = std::ssize(rows);
    Eigen::MatrixXd matrix(rows_.bins() * count, size);
    for (Eigen::Index i = 0; i < size; ++i) {
        matrix.col(i) = weighted(*rows[static_cast<std::size_t>(i)], output, first, count);
    }
    const Eigen::VectorXd wanted = weighted(target_[static_cast<std::size_t>(output)], output, first, count);
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(size, size);
    gram.selfadjointView<Eigen::Lower>().rankUpdate(matrix.transpose());
    gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
    sums.gram(acting, acting) += gram;
    sums.moment(acting) += matrix.transpose() * wanted;
}

WeightedSums EffectRegression::weighted_sums(Eigen::Index first, Eigen::Index count) const {
    std::vector<Eigen::Index> all(columns_.size());
    std::iota(all.begin(), all.end(), 0);
    WeightedSums sums = WeightedSums::zero(columns());
    for (Eigen::Index output = 0; output < outputs(); ++output) {
        add_sums(sums, output, all, first, count);
    }
    return sums;
}

WeightedSums EffectRegression::sums_of_output(Eigen::Index output,
                                              const std::vector<Eigen::Index>& columns) const {
    WeightedSums sums = WeightedSums::zero(std::ssize(columns));
    add_sums(sums, output, columns, 0, fitted_frames_);
    return sums;
}

Eigen::VectorXd EffectRegression::spent(Eigen::Index output, const std::vector<Eigen::Index>& fitted,
                                        const Eigen::MatrixXd& covariance) const {
    std::vector<Eigen::Index> acting;
    for (Eigen::Index i = 0; i < std::ssize(fitted); ++i) {
        const Eigen::Index column = fitted[static_cast<std::size_t>(i)];
        if (columns_[static_cast<std::size_t>(column)]->on(output) != nullptr) {
            acting.push_back(i);
        }
    }
    if (acting.empty()) {
        return Eigen::VectorXd::Zero(rows_.bins()); // Eigen's product would take blocks of a null pointer
    }
    Eigen::MatrixXd matrix(rows_.bins() * fitted_frames_, std::ssize(acting));
    for (Eigen::Index i = 0; i < matrix.cols(); ++i) {
        const Eigen::Index column = fitted[static_cast<std::size_t>(acting[static_cast<std::size_t>(i)])];
        matrix.col(i) =
            weighted(*columns_[static_cast<std::size_t>(column)]->on(output), output, 0, fitted_frames_);
    }
    const Eigen::VectorXd leverage =
        (matrix * covariance(acting, acting)).cwiseProduct(matrix).rowwise().sum();
    return leverage.reshaped(rows_.bins(), fitted_frames_).rowwise().sum();
}

Eigen::MatrixXd EffectRegression::residual(Eigen::Index output, const Eigen::VectorXd& coefficients) const {
    Eigen::MatrixXd left = target_[static_cast<std::size_t>(output)].leftCols(fitted_frames_);
    for (Eigen::Index column = 0; column < columns(); ++column) {
        const Eigen::MatrixXd* rows = columns_[static_cast<std::size_t>(column)]->on(output);
        if (rows != nullptr && coefficients[column] != 0) {
            left.noalias() -= coefficients[column] * rows->leftCols(fitted_frames_);
        }
    }
    return left;
}

} // namespace dfdyn::tools
