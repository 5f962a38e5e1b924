// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <random>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tests {

template <class Distribution>
std::vector<double> numbers(std::mt19937_64& engine, std::size_t count, Distribution& distribution) {
    std::vector<double> values(count);
    for (double& value : values) {
        value = distribution(engine);
    }
    return values;
}

/// A valid model of two joints and a wrench with random numbers; 2d = 6 columns.
inline tools::TrainedModel small_model(std::mt19937_64& engine, tools::InputKind kind) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> positive(0.5, 2);
    const bool full = kind == tools::InputKind::DF || kind == tools::InputKind::DFW;
    tools::TrainedModel model;
    model.joints = 2;
    model.sample_period_s = 0.004;
    model.forgetting_factor = 0.999;
    model.input.kind = kind;
    model.input.lags = 4;
    model.input.rows_per_joint = full ? 5 : 3;
    const auto rows = static_cast<std::size_t>(model.input.rows_per_joint);
    model.input.scale = numbers(engine, 2 * rows, positive);
    if (kind == tools::InputKind::STD) {
        model.input.position_noise_bound = 1e-3;
    } else {
        model.input.rows = numbers(engine, rows * 5, normal);
    }
    if (kind == tools::InputKind::DFSR) {
        model.input.alpha = {250, 62500};
        model.input.beta = {0.5, 0.7};
    }
    model.features = {true, 3, 7, numbers(engine, 3 * 2 * rows, normal), 1.5};
    model.outputs = {
        {"fx", "fy", "fz", "mx", "my", "mz"}, numbers(engine, 6, normal), numbers(engine, 6, positive), 100};
    model.limits = {{10, 10}, {100, 100, 100, 100, 100, 100}, 1e6, 250};
    model.start = {numbers(engine, 36, normal), numbers(engine, 15, normal), numbers(engine, 6, positive)};
    model.training = {{"run.csv"}, "0:100", "ML", 7, 100, -12.5, {-12.5, -13}};
    return model;
}

/// Adds random data on the outputs away from the training data.
inline void add_extrapolation(tools::TrainedModel& model, std::mt19937_64& engine) {
    std::uniform_real_distribution<double> positive(0.5, 2);
    const std::size_t outputs = model.outputs.names.size();
    model.extrapolation = {
        positive(engine), numbers(engine, outputs, positive), numbers(engine, outputs, positive), {}, 1};
}

/// Chain, effects and selected columns of an arm of two joints, one that turns and one that slides.
inline tools::PhysicsModel small_arm(bool wrench) {
    constexpr tools::ChainModel::Frame turned{{0.6, -0.8, 0, 0, 0, -1, 0.8, 0.6, 0}, {0.1, 0.2, -0.3}};
    constexpr tools::ChainModel::Frame straight{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0.4, 0, 0.1}};
    tools::PhysicsModel physics;
    physics.chain.joints = {{"shoulder", turned, {0, 0.6, 0.8}, false}, {"elbow", straight, {1, 0, 0}, true}};
    physics.chain.gravity = {0.5, -2, -9};
    if (wrench) {
        physics.chain.sensor = {"ft", 1, turned, false};
        physics.effects = {{"ft_bias", 0, 0, 0, 0, 0}, {"ft_bias", 4, 0, 0, 0, 0}};
        physics.selected = {0, 3, 7, 10, 11, 20, 21};
    } else {
        physics.effects = {{"viscous_friction", 0, 0, 0, 0, 0},   {"viscous_friction", 1, 0, 0, 0, 0},
                           {"coulomb_friction", 1, 0.3, 0, 0, 0}, {"stribeck_friction", 0, 0.3, 0.7, 0, 0},
                           {"torque_ripple", 1, 0, 0, 3, 0.5},    {"torque_offset", 1, 0, 0, 0, 0}};
        physics.selected = {1, 9, 10, 20, 21, 22, 23, 24, 25};
    }
    return physics;
}

/// The motion of the physics: from the derivatives of input STD, or from DFR.
inline tools::InputModel small_motion(std::mt19937_64& engine, std::normal_distribution<double>& normal,
                                      const tools::InputModel& input) {
    tools::InputModel motion = input;
    if (input.kind != tools::InputKind::STD) {
        motion = {};
        motion.kind = tools::InputKind::DFR;
        motion.lags = 4;
        motion.rows_per_joint = 3;
        motion.rows = numbers(engine, 15, normal);
    }
    motion.scale = {1, 1, 1, 1, 1, 1};
    return motion;
}

/// Draws the numbers of `structure` for the selected columns of a small arm.
inline void draw_learned(std::mt19937_64& engine, const std::string& structure, std::size_t outputs,
                         tools::PhysicsModel& physics) {
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> positive(0.5, 2);
    const std::size_t columns = physics.selected.size();
    physics.parameter_names.assign(columns, "parameter");
    physics.column_scale = numbers(engine, columns, positive);
    physics.output_gain = numbers(engine, outputs, positive);
    physics.start.weights = numbers(engine, columns, normal);
    if (structure == "P" || structure == "SPK") {
        physics.prior_variance = 3;
        physics.start.unit_upper = numbers(engine, columns * (columns - 1) / 2, normal);
        physics.start.diagonal = numbers(engine, columns, positive);
    }
    if (structure == "SPK") {
        physics.coupling = numbers(engine, outputs * columns * 6, normal);
    }
}

/// The same model with physics. `structure` is P, SP, SP2 or SPK; the outputs are a wrench at a sensor on
/// link 1, or the torques of the two joints. The motion comes from DFR, or with input STD from measured
/// derivatives.
inline tools::TrainedModel small_physics_model(std::mt19937_64& engine, const std::string& structure,
                                               tools::InputKind kind, bool wrench) {
    tools::TrainedModel model = small_model(engine, kind);
    std::normal_distribution<double> normal;
    if (kind == tools::InputKind::STD) {
        model.input.derivatives = tools::Derivatives::measured;
        model.input.lags = 0;
        model.input.position_noise_bound = 0;
    }
    tools::PhysicsModel physics = small_arm(wrench);
    physics.motion = small_motion(engine, normal, model.input);
    physics.motion_limit = {10, 50, 100, 10, 50, 100};
    draw_learned(engine, structure, wrench ? 6 : 2, physics);
    model.structure = structure;
    if (!wrench) {
        model.outputs.names = {"tau1", "tau2"};
        model.outputs.offset.resize(2);
        model.outputs.noise_std.resize(2);
        model.limits.output.resize(2);
        model.start.weights.resize(12);
    }
    if (structure == "P") {
        model.input = {};
        model.features = {};
        model.start = {};
    }
    model.physics = std::move(physics);
    return model;
}

} // namespace dfdyn::tests
