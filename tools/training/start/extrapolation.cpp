// SPDX-License-Identifier: Apache-2.0
#include "tools/training/start/extrapolation.hpp"

#include "dfdyn/extrapolation.hpp"
#include "tools/base/numerics/quantile.hpp"
#include "tools/base/numerics/to_vector.hpp"
#include "tools/training/data/input_map.hpp"
#include "tools/training/likelihood/random_features.hpp"
#include "tools/training/start/normal_equations.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index block_count = 5;
constexpr Index learned_rows = 3000; // maximum over all blocks
constexpr Index predicted_rows = 600;
constexpr double range_share = 0.99;
constexpr double least_range = 1e-3;            // of noise_std
constexpr double within_two_deviations = 0.954; // for a normal distribution
constexpr double near_novelty = 0.1;
constexpr std::size_t near_samples_least = 50;

/// One time block: its normal equations, and some of its rows for prediction.
struct TimeBlock {
    MatrixXd information;
    MatrixXd right_hand_side;
    MatrixXd features;
    MatrixXd targets;
};

/// Held-out errors and the novelty of their rows.
struct HeldOut {
    std::vector<double> novelty;
    std::vector<VectorXd> error; ///< m, in units of noise_std
};

TimeBlock block_of(const MatrixXd& inputs, const FeatureModel& features, const MatrixXd& targets,
                   Index predict_every, double weight) {
    const MatrixXd phi = random_features(features, inputs);
    TimeBlock block;
    block.information = weight * (phi.transpose() * phi);
    block.right_hand_side = weight * (phi.transpose() * targets);
    const auto picked = Eigen::seq(0, phi.rows() - 1, predict_every);
    block.features = phi(picked, Eigen::all);
    block.targets = targets(picked, Eigen::all);
    return block;
}

std::vector<TimeBlock> blocks_of(const TrainedModel& model, const TrainingData& data, const RowList& rows,
                                 const MatrixXd& targets) {
    const auto count = static_cast<Index>(rows.size());
    const Index stride = (count + learned_rows - 1) / learned_rows;
    const Index predict_every = std::max<Index>(1, count / stride / predicted_rows);
    std::vector<TimeBlock> blocks;
    for (Index b = 0; b < block_count; ++b) {
        RowList picked;
        std::vector<Index> of_targets;
        for (Index i = count * b / block_count; i < count * (b + 1) / block_count; i += stride) {
            picked.push_back(rows[static_cast<std::size_t>(i)]);
            of_targets.push_back(i);
        }
        blocks.push_back(block_of(stored_inputs(model.input, data, picked), model.features,
                                  targets(of_targets, Eigen::all), predict_every,
                                  static_cast<double>(stride)));
    }
    return blocks;
}

/// Learns from normal equations and predicts the rows of another block.
class Learned {
  public:
    Learned(MatrixXd information, const MatrixXd& right_hand_side, double prior_variance)
        : factor_([&] {
              information.diagonal().array() += 1 / prior_variance;
              return information_factor(std::move(information), prior_variance);
          }()),
          weights_(factor_.solve(right_hand_side)) {
        far_variance_ = factor_.inverse().trace() / static_cast<double>(weights_.rows());
    }

    void predict(const TimeBlock& block, HeldOut& held_out) const {
        const VectorXd variances = factor_.lower()
                                       .triangularView<Eigen::Lower>()
                                       .solve(block.features.transpose())
                                       .colwise()
                                       .squaredNorm()
                                       .transpose();
        const MatrixXd means = block.features * weights_;
        for (Index row = 0; row < means.rows(); ++row) {
            const Extrapolation<double> beyond(variances[row], 1 / far_variance_);
            held_out.novelty.push_back(std::min(variances[row] / far_variance_, 1.0));
            held_out.error.emplace_back((block.targets.row(row) - (1 - beyond.doubt()) * means.row(row)));
        }
    }

  private:
    CovarianceFactor factor_;
    MatrixXd weights_;
    double far_variance_ = 0;
};

HeldOut held_out_errors(const std::vector<TimeBlock>& blocks, double prior_variance) {
    MatrixXd information = blocks.front().information;
    MatrixXd right_hand_side = blocks.front().right_hand_side;
    for (std::size_t b = 1; b < blocks.size(); ++b) {
        information += blocks[b].information;
        right_hand_side += blocks[b].right_hand_side;
    }
    HeldOut held_out;
    for (const TimeBlock& block : blocks) {
        const Learned from_others(information - block.information, right_hand_side - block.right_hand_side,
                                  prior_variance);
        from_others.predict(block, held_out);
        const Learned from_it(block.information, block.right_hand_side, prior_variance);
        for (const TimeBlock& other : blocks) {
            if (&other != &block) {
                from_it.predict(other, held_out);
            }
        }
    }
    return held_out;
}

/// Returns the extra noise of one output.
double extra_noise(const HeldOut& held_out, Index output, double prior_variance) {
    std::vector<double> near;
    std::vector<double> all;
    for (std::size_t i = 0; i < held_out.novelty.size(); ++i) {
        const double t = held_out.novelty[i];
        const double error = held_out.error[i][output];
        const Extrapolation<double> beyond(t, 1);
        const double unexplained = error * error / 4 - prior_variance * beyond.unknown();
        all.push_back(unexplained);
        if (t < near_novelty) {
            near.push_back(unexplained);
        }
    }
    const std::vector<double>& samples = near.size() < near_samples_least ? all : near;
    return std::max(quantile(samples, within_two_deviations) - 1, 0.0);
}

/// Returns the prior variance in units of noise_std squared. The range of an output that is 0 in nearly all
/// rows, such as with closed brakes, is its largest magnitude.
double prior_variance(const MatrixXd& targets, Index output, double offset) {
    const VectorXd magnitudes = (targets.col(output).array() + offset).abs();
    const double usual = quantile(to_vector(magnitudes), range_share);
    const double range = usual < least_range ? magnitudes.maxCoeff() : usual;
    return range * range / 3 + offset * offset;
}

/// Returns trace(U D U') / size.
double mean_variance(const StartModel& start) {
    double trace = 0;
    auto upper = start.unit_upper.begin();
    for (std::size_t column = 0; column < start.diagonal.size(); ++column) {
        double norm = 1;
        for (std::size_t row = 0; row < column; ++row, ++upper) {
            norm += *upper * *upper;
        }
        trace += norm * start.diagonal[column];
    }
    return trace / static_cast<double>(start.diagonal.size());
}

/// The physics' part of one time block.
struct PhysicsBlock {
    MatrixXd information;
    VectorXd right_hand_side;
    MatrixXd columns; ///< rows for prediction, in units of noise_std: (rows m) x p
    VectorXd targets;
};

PhysicsBlock physics_block(const PhysicsProblem& problem, Index first, Index last, Index stride) {
    const auto outputs = static_cast<Index>(problem.model.outputs.noise_std.size());
    const Index p = problem.columns.cols() / outputs;
    const MatrixXd targets = scaled_outputs(problem.model.outputs, problem.data.outputs, problem.rows);
    const auto picked = Eigen::seq(first, last - 1, stride);
    PhysicsBlock block{MatrixXd::Zero(p, p), VectorXd::Zero(p), {}, {}};
    const MatrixXd measured = targets(picked, Eigen::all);
    block.columns.resize(measured.size(), p);
    block.targets.resize(measured.size());
    for (Index k = 0; k < outputs; ++k) {
        const MatrixXd psi = problem.columns(picked, Eigen::seqN(k * p, p)) /
                             problem.model.outputs.noise_std[static_cast<std::size_t>(k)];
        block.columns.middleRows(k * measured.rows(), measured.rows()) = psi;
        block.targets.segment(k * measured.rows(), measured.rows()) = measured.col(k);
    }
    const auto weight = static_cast<double>(stride);
    block.information = weight * (block.columns.transpose() * block.columns);
    block.right_hand_side = weight * (block.columns.transpose() * block.targets);
    return block;
}

/// Appends, for each output, the squared errors on a block divided by four (two standard deviations). The
/// variance of the parameters learned from the equations, times `factor`, is subtracted.
void predict_physics(const NormalEquations& equations, const ParameterPrior& prior, double factor,
                     const PhysicsBlock& block, std::vector<std::vector<double>>& unexplained) {
    const CovarianceFactor learned = information_factor(equations.information + prior.information, 1);
    const VectorXd parameters =
        learned.solve(equations.right_hand_side + prior.information * prior.mean).col(0);
    const VectorXd errors = block.targets - block.columns * parameters;
    const VectorXd variances = learned.lower()
                                   .triangularView<Eigen::Lower>()
                                   .solve(block.columns.transpose())
                                   .colwise()
                                   .squaredNorm()
                                   .transpose();
    const Index rows = errors.size() / static_cast<Index>(unexplained.size());
    for (Index i = 0; i < errors.size(); ++i) {
        unexplained[static_cast<std::size_t>(i / rows)].push_back(errors[i] * errors[i] / 4 -
                                                                  factor * variances[i]);
    }
}

} // namespace

std::vector<double> output_variances(const TrainedModel& model, const TrainingData& data,
                                     const RowList& rows) {
    const MatrixXd outputs = scaled_outputs(model.outputs, data.outputs, rows);
    std::vector<double> result;
    for (Index k = 0; k < outputs.cols(); ++k) {
        result.push_back(prior_variance(outputs, k, 0));
    }
    return result;
}

ExtrapolationModel measure_parametric_extrapolation(const PhysicsProblem& problem,
                                                    const ParameterPrior& prior,
                                                    double parameter_variance_factor) {
    const auto count = static_cast<Index>(problem.rows.size());
    const Index stride = (count + learned_rows - 1) / learned_rows;
    std::vector<PhysicsBlock> blocks;
    for (Index b = 0; b < block_count; ++b) {
        blocks.push_back(
            physics_block(problem, count * b / block_count, count * (b + 1) / block_count, stride));
    }
    NormalEquations all{MatrixXd::Zero(prior.mean.size(), prior.mean.size()),
                        MatrixXd::Zero(prior.mean.size(), 1)};
    for (const PhysicsBlock& block : blocks) {
        all.information += block.information;
        all.right_hand_side += block.right_hand_side;
    }
    std::vector<std::vector<double>> unexplained(problem.model.outputs.noise_std.size());
    for (const PhysicsBlock& block : blocks) {
        predict_physics({all.information - block.information, all.right_hand_side - block.right_hand_side},
                        prior, parameter_variance_factor, block, unexplained);
        for (const PhysicsBlock& other : blocks) {
            if (&other != &block) {
                predict_physics({block.information, block.right_hand_side}, prior, parameter_variance_factor,
                                other, unexplained);
            }
        }
    }
    ExtrapolationModel result;
    result.parameter_variance_factor = parameter_variance_factor;
    result.prior_variance.assign(unexplained.size(), 0);
    result.output_variance = output_variances(problem.model, problem.data, problem.rows);
    for (std::vector<double>& of_output : unexplained) {
        result.extra_noise.push_back(
            std::max(quantile(std::move(of_output), within_two_deviations) - 1, 0.0));
    }
    return result;
}

ExtrapolationModel measure_extrapolation(const TrainedModel& model, const TrainingData& data,
                                         const RowList& rows, const MatrixXd& targets) {
    const HeldOut held_out =
        held_out_errors(blocks_of(model, data, rows, targets), model.outputs.prior_variance);
    ExtrapolationModel result;
    result.inverse_far_variance = 1 / mean_variance(model.start);
    for (Index k = 0; k < targets.cols(); ++k) {
        const auto output = static_cast<std::size_t>(k);
        const double offset = model.outputs.offset[output] / model.outputs.noise_std[output];
        result.prior_variance.push_back(prior_variance(targets, k, offset));
        result.extra_noise.push_back(extra_noise(held_out, k, result.prior_variance.back()));
    }
    return result;
}

} // namespace dfdyn::tools
