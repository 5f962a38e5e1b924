// SPDX-License-Identifier: Apache-2.0
#include "tools/training/search/fit_problem.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/training/likelihood/feature_likelihood.hpp"
#include "tools/training/likelihood/physics_likelihood.hpp"
#include "tools/training/likelihood/random_features.hpp"

#include <numeric>
#include <utility>

namespace dfdyn::tools {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

/// -2 log marginal likelihood of physics and white noise only (model P): theta = [input's own, physics' own],
/// possibly empty. Refers to `outputs`.
class ParametricLikelihood final : public Likelihood {
  public:
    explicit ParametricLikelihood(const OutputLikelihood& outputs) : outputs_(outputs) {}

    /// O(N m p^2), plus the regressor of every sample.
    std::optional<LikelihoodValue> evaluate(const VectorXd& theta) const override {
        auto evidence = outputs_.evaluate(WhiteCovariance(), theta);
        if (!evidence) {
            return std::nullopt;
        }
        return finite_or_nothing({evidence->minus_two_log_likelihood, std::move(evidence->parameter_gradient),
                                  std::move(evidence->output_variance), std::move(evidence->physics)});
    }

  private:
    const OutputLikelihood& outputs_;
};

std::unique_ptr<OutputLikelihood> output_likelihood(MatrixXd outputs, const PhysicsColumns* physics,
                                                    PhysicsPrior prior) {
    if (physics == nullptr) {
        return std::make_unique<ProfiledVarianceLikelihood>(std::move(outputs));
    }
    return std::make_unique<PhysicsLikelihood>(std::move(outputs), *physics, prior);
}

} // namespace

PhysicsPart given_physics(const TrainingSetup& setup) {
    const VectorXd& given = *setup.options.physics.given;
    PhysicsPart part{
        {{}, VectorXd::Ones(given.size())}, setup.motion_start(setup.options.input), {given, {}}};
    part.choice.columns.resize(static_cast<std::size_t>(given.size()));
    std::iota(part.choice.columns.begin(), part.choice.columns.end(), 0);
    return part;
}

MatrixXd remaining_outputs(const TrainingSetup& setup, const FitModel& model, const RowList& at) {
    MatrixXd outputs = setup.outputs(at).rowwise() - model.offset.transpose();
    if (model.mean) {
        const MatrixXd columns =
            setup.physics(setup.options.input, at, model.mean->choice)->evaluate(model.mean->motion);
        const VectorXd& parameters = model.mean->fit.parameters;
        for (Index k = 0; k < outputs.cols(); ++k) {
            outputs.col(k) -= columns.middleCols(k * parameters.size(), parameters.size()) * parameters;
        }
    }
    return outputs;
}

FitProblem::FitProblem(const TrainingSetup& setup, InputKind kind, const RowList& at, const FitModel& model)
    : setup_(setup), kind_(kind), kernel_(model.kernel), input_(setup.input(kind, at)),
      physics_(model.columns ? setup.physics(kind, at, *model.columns) : nullptr),
      outputs_(output_likelihood(remaining_outputs(setup, model, at), physics_.get(), model.prior)) {
    if (kernel_) {
        exact_ = std::make_unique<MarginalLikelihood>(*input_, *outputs_);
    } else {
        exact_ = std::make_unique<ParametricLikelihood>(*outputs_);
    }
}

Bounds FitProblem::bounds() const {
    if (kernel_) {
        return MarginalLikelihood(*input_, *outputs_).bounds();
    }
    const Bounds input = input_->bounds();
    const Bounds own = outputs_->bounds();
    return {concatenated(input.lower, own.lower), concatenated(input.upper, own.upper)};
}

VectorXd FitProblem::start(int index) const {
    NormalSource random(setup_.options.seed, static_cast<std::uint32_t>(index));
    if (kernel_) {
        return MarginalLikelihood(*input_, *outputs_).start(index, random);
    }
    const VectorXd input = input_->start(index, random);
    return concatenated(input, outputs_->start(input));
}

std::unique_ptr<Likelihood> FitProblem::running() const {
    if (!kernel_) {
        return std::make_unique<ParametricLikelihood>(*outputs_);
    }
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const TrainingOptions& options = setup_.options;
    const auto inputs = static_cast<int>(input_->inputs(split(start(0)).input).cols());
    const FeatureModel features =
        draw_features(options.feature_count, inputs, options.orthogonal, 1, options.seed);
    return std::make_unique<FeatureLikelihood>(
        *input_, *outputs_, Eigen::Map<const RowMajor>(features.omega.data(), options.feature_count, inputs));
}

VectorXd FitProblem::start_from(const FitProblem& structured, const VectorXd& theta) const {
    const VectorXd from = structured.split(theta).input;
    VectorXd result = start(0);
    const Index inputs = input_->bounds().lower.size();
    const VectorXd input = setup_.row_family(kind_)->parameters_of(
        setup_.row_family(structured.kind_)->evaluate(from), result.segment(first_input(), inputs));
    result << theta.head(first_input()), input, physics_from(structured, theta, input);
    return result;
}

VectorXd FitProblem::physics_from(const FitProblem& structured, const VectorXd& theta,
                                  const VectorXd& input) const {
    const Hyperparameters from = structured.split(theta);
    if (physics_ == nullptr || setup_.options.physics.motion != PhysicsMotion::of_input) {
        return from.physics;
    }
    const InputRows rows = setup_.row_family(kind_)->evaluate(input);
    const MatrixXd wanted = setup_.motion_rows(structured.kind_)->evaluate(from.input);
    return concatenated(log_factors(rows.rows.middleRows(1, 2), wanted, setup_.spread.pooled_factor()),
                        from.physics);
}

Hyperparameters FitProblem::split(const VectorXd& theta) const {
    if (kernel_) {
        return MarginalLikelihood(*input_, *outputs_).split(theta);
    }
    const Index inputs = input_->bounds().lower.size();
    return {0, 0, theta.head(inputs), theta.tail(theta.size() - inputs)};
}

} // namespace dfdyn::tools
