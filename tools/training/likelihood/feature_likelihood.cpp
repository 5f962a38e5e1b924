// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/feature_likelihood.hpp"

#include "tools/training/likelihood/covariance.hpp"
#include "tools/training/likelihood/marginal_likelihood.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace dfdyn::tools {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// Features of some samples, and intermediate results for the chain rule.
struct Features {
    MatrixXd phase; ///< N x d: omega xi / l
    MatrixXd phi;   ///< N x 2d
};

Features features_of(const MatrixXd& inputs, const MatrixXd& omega, double length_scale) {
    Features features;
    features.phase = inputs * omega.transpose() / length_scale;
    const double amplitude = 1 / std::sqrt(static_cast<double>(omega.rows()));
    features.phi.resize(inputs.rows(), 2 * omega.rows());
    features.phi << amplitude * features.phase.array().cos().matrix(),
        amplitude * features.phase.array().sin().matrix();
    return features;
}

/// Converts the gradient with respect to phi to that with respect to the phases.
MatrixXd pull_back_to_phase(const Features& features, const MatrixXd& phi_gradient) {
    const Index d = features.phase.cols();
    return features.phi.leftCols(d).cwiseProduct(phi_gradient.rightCols(d)) -
           features.phi.rightCols(d).cwiseProduct(phi_gradient.leftCols(d));
}

/// The features of all samples in blocks of rows. One block is kept; several are computed again for each
/// pass, so that memory does not grow with the number of samples. Refers to its arguments.
class FeatureBlocks {
  public:
    FeatureBlocks(const MatrixXd& inputs, const MatrixXd& omega, double length_scale, Index rows_at_once)
        : inputs_(inputs), omega_(omega), length_scale_(length_scale), rows_at_once_(rows_at_once) {
        if (rows() <= rows_at_once_) {
            all_ = features_of(inputs_, omega_, length_scale_);
        }
    }

    Index rows() const { return inputs_.rows(); }
    Index columns() const { return 2 * omega_.rows(); }

    /// Calls `use` with the first row and the features of each block, in order.
    template <class Function>
    void for_each(const Function& use) const {
        if (all_) {
            use(Index{0}, *all_);
            return;
        }
        for (Index first = 0; first < rows(); first += rows_at_once_) {
            const Index count = std::min(rows_at_once_, rows() - first);
            use(first, features_of(inputs_.middleRows(first, count), omega_, length_scale_));
        }
    }

    /// Returns Phi' times a matrix with a row per sample.
    MatrixXd transposed_times(const MatrixXd& right) const {
        MatrixXd products = MatrixXd::Zero(columns(), right.cols());
        for_each([&](Index first, const Features& block) {
            products.noalias() += block.phi.transpose() * right.middleRows(first, block.phi.rows());
        });
        return products;
    }

  private:
    const MatrixXd& inputs_;
    const MatrixXd& omega_;
    double length_scale_;
    Index rows_at_once_;
    std::optional<Features> all_;
};

/// C = Phi Phi' + r I by the matrix inversion lemma. Refers to Phi, which must outlive it.
class RidgeCovariance final : public Covariance {
  public:
    /// Returns nothing if Phi' Phi + r I is not positive definite in double precision. O(N (2d)^2 + (2d)^3).
    static std::optional<RidgeCovariance> of(const FeatureBlocks& features, double noise_ratio) {
        MatrixXd information = MatrixXd::Zero(features.columns(), features.columns());
        features.for_each([&](Index /*first*/, const Features& block) {
            information.selfadjointView<Eigen::Lower>().rankUpdate(block.phi.transpose());
        });
        information.diagonal().array() += noise_ratio;
        Eigen::LLT<MatrixXd> factor(information);
        if (factor.info() != Eigen::Success) {
            return std::nullopt;
        }
        return RidgeCovariance(features, noise_ratio, std::move(factor));
    }

    double log_determinant() const override {
        return static_cast<double>(features_->rows() - features_->columns()) * std::log(noise_ratio_) +
               2 * factor_.matrixLLT().diagonal().array().log().sum();
    }

    /// O(N 2d) per column of B.
    MatrixXd solve(const MatrixXd& right_hand_sides) const override {
        const MatrixXd weights = factor_.solve(features_->transposed_times(right_hand_sides));
        MatrixXd solved(right_hand_sides.rows(), right_hand_sides.cols());
        features_->for_each([&](Index first, const Features& block) {
            const Index count = block.phi.rows();
            solved.middleRows(first, count) =
                (right_hand_sides.middleRows(first, count) - block.phi * weights) / noise_ratio_;
        });
        return solved;
    }

    /// Returns (Phi' Phi + r I)^-1, 2d x 2d; C^-1 Phi = Phi times it.
    MatrixXd inverse_information() const {
        return factor_.solve(MatrixXd::Identity(features_->columns(), features_->columns()));
    }

    /// Returns r tr C^-1, from inverse_information().
    double scaled_trace(const MatrixXd& inverse_information) const {
        return static_cast<double>(features_->rows() - features_->columns()) +
               noise_ratio_ * inverse_information.trace();
    }

  private:
    RidgeCovariance(const FeatureBlocks& features, double noise_ratio, Eigen::LLT<MatrixXd> factor)
        : features_(&features), noise_ratio_(noise_ratio), factor_(std::move(factor)) {}

    const FeatureBlocks* features_;
    double noise_ratio_;
    Eigen::LLT<MatrixXd> factor_;
};

/// Gradient with respect to r, l and the inputs.
struct RidgeGradient {
    double log_noise_ratio = 0;
    double log_length_scale = 0;
    MatrixXd inputs; ///< N x (n k)
};

/// Returns directions' Phi, q x 2d.
MatrixXd projected_directions(const Evidence& evidence, const FeatureBlocks& features) {
    MatrixXd products = MatrixXd::Zero(evidence.directions.cols(), features.columns());
    features.for_each([&](Index first, const Features& block) {
        products.noalias() += evidence.directions.middleRows(first, block.phi.rows()).transpose() * block.phi;
    });
    return products;
}

RidgeGradient contract(const Evidence& evidence, const RidgeCovariance& covariance,
                       const FeatureBlocks& features, const MatrixXd& omega, double noise_ratio,
                       double length_scale) {
    const MatrixXd inverse = covariance.inverse_information();
    const MatrixXd back = evidence.weights.asDiagonal() * projected_directions(evidence, features);
    RidgeGradient gradient;
    gradient.log_noise_ratio =
        evidence.count * covariance.scaled_trace(inverse) -
        noise_ratio * evidence.directions.colwise().squaredNorm().dot(evidence.weights.transpose());
    gradient.inputs.resize(features.rows(), omega.cols());
    features.for_each([&](Index first, const Features& block) {
        const Index count = block.phi.rows();
        MatrixXd phi_gradient(count, block.phi.cols());
        phi_gradient.noalias() = 2 * evidence.count * block.phi * inverse;
        phi_gradient.noalias() -= 2 * evidence.directions.middleRows(first, count) * back;
        const MatrixXd phase_gradient = pull_back_to_phase(block, phi_gradient);
        gradient.log_length_scale -= phase_gradient.cwiseProduct(block.phase).sum();
        gradient.inputs.middleRows(first, count) = phase_gradient * omega / length_scale;
    });
    return gradient;
}

} // namespace

Index feature_rows_at_once(Index frequencies) {
    constexpr Index most_bytes = 200'000'000;
    constexpr Index bytes_per_feature = 9 * sizeof(double); // with the gradients and intermediate results
    return std::max<Index>(1, most_bytes / (bytes_per_feature * frequencies));
}

std::optional<LikelihoodValue> FeatureLikelihood::evaluate(const VectorXd& theta) const {
    const double noise_ratio = std::exp(theta[0]);
    const double length_scale = std::exp(theta[1]);
    const VectorXd input = theta.segment(kernel_parameters, input_.bounds().lower.size());
    const MatrixXd inputs = input_.inputs(input);
    const FeatureBlocks features(inputs, omega_, length_scale, rows_at_once_);
    const auto covariance = RidgeCovariance::of(features, noise_ratio);
    if (!covariance) {
        return std::nullopt;
    }
    const auto evidence = outputs_.evaluate(*covariance, theta.tail(theta.size() - kernel_parameters));
    if (!evidence) {
        return std::nullopt;
    }
    const RidgeGradient gradient =
        contract(*evidence, *covariance, features, omega_, noise_ratio, length_scale);
    LikelihoodValue value{
        evidence->minus_two_log_likelihood, {}, evidence->output_variance, evidence->physics};
    value.gradient =
        joined(gradient.log_noise_ratio, gradient.log_length_scale, evidence->parameter_gradient);
    value.gradient.segment(kernel_parameters, input.size()) += input_.pull_back(input, gradient.inputs);
    return finite_or_nothing(std::move(value));
}

} // namespace dfdyn::tools
