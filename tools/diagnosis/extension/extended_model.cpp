// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/extension/extended_model.hpp"

#include "tools/base/numerics/to_vector.hpp"
#include "tools/base/text/error.hpp"
#include "tools/model/chain_model.hpp"
#include "tools/model/inputs/derivative_rows.hpp"
#include "tools/model/structure.hpp"
#include "tools/replay/contradiction.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/identification/base_parameters.hpp"
#include "tools/robot/regressor.hpp"
#include "tools/training/data/recorded_data.hpp"
#include "tools/training/data/stored_motion.hpp"
#include "tools/training/physics/robot_regressor.hpp"
#include "tools/training/start/limits.hpp"
#include "tools/training/start/normal_equations.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double window_s = 0.2;
constexpr int most_lags = 100;
/// poles for comparison
constexpr std::array filter_poles{0.0, 0.3, 0.5, 0.65, 0.75, 0.83, 0.9, 0.95};
constexpr std::size_t rows_for_filters = 1500; ///< for the comparison of filters
constexpr std::size_t rows_for_noise = 20'000; ///< bounds the memory of their windows

/// Velocity and acceleration as weighted means of first and second differences, with one pole each.
InputModel filters(double velocity_pole, double acceleration_pole, const TrainingData& data) {
    InputModel motion;
    motion.kind = InputKind::DFR;
    motion.lags = std::clamp(static_cast<int>(std::lround(window_s / data.sample_period_s)), 4, most_lags);
    motion.rows_per_joint = 3;
    motion.scale.assign(3 * static_cast<std::size_t>(data.positions.cols()), 1);
    MatrixXd rows = MatrixXd::Zero(motion.lags + 1, 3);
    rows(0, 0) = 1;
    rows.col(1) = mean_difference_row(1, velocity_pole, motion.lags) / data.sample_period_s;
    rows.col(2) = mean_difference_row(2, acceleration_pole, motion.lags) /
                  (data.sample_period_s * data.sample_period_s);
    motion.rows = to_vector(rows);
    return motion;
}

/// Prediction of the extension along recorded positions.
class Prediction {
  public:
    Prediction(const ModelExtension& extension, const TrainingData& data)
        : data_(data), chain_(chain_model(extension.robot, extension.kind)),
          gain_(to_vector(extension.output_gain)),
          parameters_(extension.bodies.size() + static_cast<Index>(extension.columns.size())) {
        parameters_.head(extension.bodies.size()) = extension.bodies;
        for (std::size_t i = 0; i < extension.columns.size(); ++i) {
            effects_.push_back(extension.columns[i].effect);
            parameters_[extension.bodies.size() + static_cast<Index>(i)] = extension.columns[i].value;
        }
        regressor_ = robot_regressor(chain_, effects_, gain_);
    }

    const ChainModel& chain() const { return chain_; }
    const std::vector<EffectModel>& effects() const { return effects_; }

    /// Returns measured minus predicted outputs, rows x m.
    MatrixXd error(const InputModel& motion, const RowList& rows) const {
        const MotionSamples samples = stored_motion(motion, data_, rows);
        MatrixXd error(static_cast<Index>(rows.size()), data_.outputs.cols());
        MatrixXd values;
        for (Index i = 0; i < error.rows(); ++i) {
            regressor_->evaluate(samples.at(i), values);
            error.row(i) =
                data_.outputs.row(rows[static_cast<std::size_t>(i)]) - (values * parameters_).transpose();
        }
        return error;
    }

  private:
    const TrainingData& data_;
    ChainModel chain_;
    std::vector<EffectModel> effects_;
    std::vector<double> gain_;
    VectorXd parameters_;
    std::unique_ptr<Regressor> regressor_;
};

VectorXd mean_square(const MatrixXd& error) {
    return error.colwise().squaredNorm() / static_cast<double>(error.rows());
}

VectorXd variance(const MatrixXd& outputs) {
    return mean_square(outputs.rowwise() - outputs.colwise().mean()).cwiseMax(1e-12);
}

/// Returns about `most` evenly distributed rows with full windows, or all.
RowList some_rows(const TrainingData& data, int lags, std::size_t most) {
    const RowList usable = usable_rows(data.gap_before, lags);
    if (usable.empty()) {
        throw InputError("recording: expected stretches of more than " + std::to_string(lags) +
                         " rows without a gap, found none");
    }
    RowList rows;
    const std::size_t step = std::max<std::size_t>(1, usable.size() / most);
    for (std::size_t i = 0; i < usable.size(); i += step) {
        rows.push_back(usable[i]);
    }
    return rows;
}

InputModel best_filters(const Prediction& prediction, const TrainingData& data) {
    const RowList rows = some_rows(data, filters(0, 0, data).lags, rows_for_filters);
    const VectorXd weight = variance(data.outputs).cwiseInverse();
    InputModel best;
    double least = std::numeric_limits<double>::infinity();
    for (const double velocity : filter_poles) {
        for (const double acceleration : filter_poles) {
            InputModel motion = filters(velocity, acceleration, data);
            const double error = mean_square(prediction.error(motion, rows)).dot(weight);
            if (error < least) {
                least = error;
                best = std::move(motion);
            }
        }
    }
    return best;
}

/// Prior standard deviations of a body's inertial parameters, for a mass error of a tenth and a
/// centre-of-mass error of 2 cm.
VectorXd body_deviation(const VectorXd& bodies) {
    constexpr double share = 0.1;
    constexpr double least_kg = 0.05;
    constexpr double reach_m = 0.02;
    VectorXd deviation = share * bodies.cwiseAbs();
    for (Index first = 0; first < bodies.size(); first += 10) {
        const double mass = bodies[first] + least_kg;
        deviation.segment<1>(first).array() += least_kg;
        deviation.segment<3>(first + 1).array() += mass * reach_m;
        deviation.segment<6>(first + 4).array() += mass * reach_m * reach_m;
    }
    return deviation;
}

/// Initial values of the learned parameters (base parameters of the bodies, then the effects) and their
/// covariance.
struct StartingPoint {
    std::vector<int> selected;
    std::vector<std::string> names;
    VectorXd value;
    MatrixXd covariance;
};

StartingPoint starting_point(const ModelExtension& extension, const Prediction& prediction) {
    constexpr Index states = 300;
    const MatrixXd regressor =
        stacked_regressor(extension.robot, extension.kind, random_motion(extension.robot, states, 1));
    const BaseParameters base = find_base_parameters(regressor);
    const std::vector<std::string> names =
        column_names(extension.robot, prediction.chain(), prediction.effects());
    const auto effects = static_cast<Index>(extension.columns.size());
    const Index count = base.count() + effects;
    StartingPoint start{{}, {}, VectorXd(count), MatrixXd::Zero(count, count)};
    const MatrixXd spread = base.combination * body_deviation(extension.bodies).asDiagonal();
    start.value.head(base.count()) = base.combination * extension.bodies;
    start.covariance.topLeftCorner(base.count(), base.count()) = spread * spread.transpose();
    for (const Index column : base.independent) {
        start.selected.push_back(static_cast<int>(column));
    }
    for (Index i = 0; i < effects; ++i) {
        const ExtensionColumn& column = extension.columns[static_cast<std::size_t>(i)];
        start.selected.push_back(static_cast<int>(extension.bodies.size() + i));
        start.value[base.count() + i] = column.value;
        start.covariance(base.count() + i, base.count() + i) = std::pow(std::max(column.deviation, 1e-6), 2);
    }
    for (const int column : start.selected) {
        start.names.push_back(names[static_cast<std::size_t>(column)]);
    }
    return start;
}

/// Scales each parameter by its standard deviation, so that the covariance becomes a correlation matrix.
void set_start(PhysicsModel& physics, const StartingPoint& start) {
    const VectorXd deviation = start.covariance.diagonal().cwiseSqrt();
    const MatrixXd correlation =
        deviation.cwiseInverse().asDiagonal() * start.covariance * deviation.cwiseInverse().asDiagonal();
    physics.selected = start.selected;
    physics.parameter_names = start.names;
    physics.column_scale = to_vector(deviation);
    physics.prior_variance = 1;
    physics.start.weights = to_vector(VectorXd(start.value.cwiseQuotient(deviation)));
    store_covariance(correlation, physics.start.unit_upper, physics.start.diagonal);
}

} // namespace

TrainedModel extended_model(const ModelExtension& extension, std::span<const Recording> recordings) {
    const TrainingData data = gather_training_data(recordings);
    const Prediction prediction(extension, data);
    PhysicsModel physics;
    physics.chain = prediction.chain();
    physics.effects = prediction.effects();
    physics.output_gain = to_vector(extension.output_gain);
    physics.motion = best_filters(prediction, data);
    physics.motion_limit = motion_limits(physics.motion, data);
    set_start(physics, starting_point(extension, prediction));
    const RowList rows = some_rows(data, physics.motion.lags, rows_for_noise);
    const VectorXd noise = mean_square(prediction.error(physics.motion, rows)).cwiseSqrt();
    TrainedModel model;
    model.structure = structures::P.name;
    model.joints = static_cast<int>(data.positions.cols());
    model.sample_period_s = data.sample_period_s;
    model.physics = std::move(physics);
    model.outputs = {data.output_names, std::vector<double>(data.output_names.size(), 0),
                     to_vector(VectorXd(noise.cwiseMax(1e-6)))};
    model.limits = limits_of(data);
    model.training.method = "diagnosis";
    model.training.recordings = file_names(recordings);
    calibrate_innovation_limit(model, recordings, false);
    return model;
}

} // namespace dfdyn::tools
