// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/error.hpp"
#include "tools/training/likelihood/physics_likelihood.hpp"
#include "tools/training/search/fit.hpp"
#include "tools/training/search/fit_problem.hpp"
#include "tools/training/search/hold_out.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Returns the first part of the likelihood rows, on which the grid's models are trained.
RowList training_part(const TrainingSetup& setup) {
    const RowList& rows = setup.rows.likelihood;
    const double wanted = setup.options.training_share * static_cast<double>(rows.size());
    const auto count = std::clamp<std::size_t>(static_cast<std::size_t>(wanted), 1, rows.size() - 1);
    return {rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(count)};
}

constexpr const char* dependent_columns =
    "training: expected physics that least squares can solve for, found dependent columns";
constexpr const char* infinite_grid =
    "training: expected a finite likelihood at the best point of the grid, found none";

/// Returns the result. Throws InputError with `message` if there is none.
template <class Result>
Result expect_result(std::optional<Result> result, const char* message) {
    if (!result) {
        throw InputError(message);
    }
    return *std::move(result);
}

/// Returns the least-squares solution over `at`, or the parameters given by the caller.
PhysicsPart physics_over(const TrainingSetup& setup, const RowList& at) {
    if (setup.options.physics.given) {
        return given_physics(setup);
    }
    PhysicsPart part;
    part.choice = choose_columns(setup);
    part.motion = setup.motion_start(setup.options.input);
    const MatrixXd columns = setup.physics(setup.options.input, at, part.choice)->evaluate(part.motion);
    const MatrixXd outputs = setup.outputs(at);
    const VarianceComponents best = expect_result(
        best_variances(linear_statistics(outputs, columns, outputs, columns), PhysicsPrior::none),
        dependent_columns);
    part.fit.parameters = best.at.parameters;
    return part;
}

const HoldOutPoint& finite_best(const std::vector<HoldOutPoint>& points) {
    const HoldOutPoint& best = best_point(points);
    if (!std::isfinite(best.error)) {
        throw InputError("training: expected a finite error on the held-out samples for at least one of " +
                         std::to_string(points.size()) + " points of the grid, found none");
    }
    return best;
}

PointCallback counted(const ProgressCallback& progress, int points) {
    if (!progress) {
        return {};
    }
    return [&progress, so_far = TrainingProgress{true, 0, points, std::nullopt}]() mutable {
        ++so_far.evaluations;
        progress(so_far);
    };
}

TrainingRecord record_of(const TrainingSetup& setup, double minus_two_log_likelihood) {
    TrainingRecord record;
    record.method = "CV";
    record.seed = setup.options.seed;
    record.likelihood_rows = static_cast<int>(setup.rows.likelihood.size());
    record.log_likelihood = -0.5 * minus_two_log_likelihood;
    record.all_starts = {record.log_likelihood};
    return record;
}

FitModel kernel_model(const TrainingSetup& setup, const RowList& at) {
    FitModel model;
    model.offset = output_offset(setup);
    if (setup.options.model->physics == PhysicsRole::fixed_first) {
        model.mean = physics_over(setup, at);
    }
    return model;
}

Fit fit_kernel(const TrainingSetup& setup, const ProgressCallback& progress) {
    const RowList& rows = setup.rows.likelihood;
    const RowList first = training_part(setup);
    const FitModel model = kernel_model(setup, rows);
    const FitProblem problem(setup, setup.options.input, rows, model);
    VectorXd theta = problem.start(0);
    std::vector<HoldOutPoint> points =
        hold_out_kernel(problem.input().inputs(problem.split(theta).input),
                        remaining_outputs(setup, kernel_model(setup, first), rows),
                        static_cast<Index>(first.size()), counted(progress, kernel_grid_points));
    const HoldOutPoint best = finite_best(points);
    theta.head(kernel_parameters) << std::log(best.noise_ratio), std::log(best.length_scale);
    const LikelihoodValue value = expect_result(problem.exact().evaluate(theta), infinite_grid);
    return {problem.split(theta),
            value.output_variance,
            model.offset,
            model.mean,
            record_of(setup, value.minus_two_log_likelihood),
            std::move(points)};
}

Fit fit_parametric(const TrainingSetup& setup, const ProgressCallback& progress) {
    const RowList& rows = setup.rows.likelihood;
    PhysicsPart part = physics_over(setup, rows);
    const MatrixXd columns = setup.physics(setup.options.input, rows, part.choice)->evaluate(part.motion);
    const MatrixXd outputs = setup.outputs(rows);
    std::vector<HoldOutPoint> points =
        expect_result(hold_out_physics(columns, outputs, static_cast<Index>(training_part(setup).size()),
                                       counted(progress, physics_grid_points)),
                      dependent_columns);
    const VectorXd log_prior = VectorXd::Constant(1, std::log(finite_best(points).prior_variance));
    const VarianceComponents best =
        expect_result(best_variances(linear_statistics(outputs, columns, outputs, columns),
                                     PhysicsPrior::shared, log_prior),
                      infinite_grid);
    part.fit = {best.at.parameters, best.prior_variance};
    Fit fit;
    fit.hyper.input = part.motion.head(setup.input(setup.options.input, rows)->bounds().lower.size());
    fit.output_variance = best.output_variance;
    fit.offset = output_offset(setup);
    fit.record = record_of(setup, best.at.value);
    fit.physics = std::move(part);
    fit.hold_out = std::move(points);
    return fit;
}

} // namespace

Fit fit_by_hold_out(const TrainingSetup& setup, const ProgressCallback& progress) {
    return setup.options.model->features ? fit_kernel(setup, progress) : fit_parametric(setup, progress);
}

} // namespace dfdyn::tools
