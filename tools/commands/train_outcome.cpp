// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/train_outcome.hpp"

#include "tools/base/text/text.hpp"
#include "tools/model/effects.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/model/structure.hpp"
#include "tools/training/likelihood/marginal_likelihood.hpp"
#include "tools/training/search/hold_out.hpp"

#include <nlohmann/json.hpp>

#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

namespace {

void print_physics(const PhysicsModel& physics) {
    std::cout << "physics: " << physics.selected.size()
              << " parameters that the recording determines separately"
              << (physics.prior_variance > 0 ? ", which continue to learn" : ", fixed")
              << "; each represents a determined combination of parameters\n";
    for (std::size_t i = 0; i < physics.selected.size(); ++i) {
        std::cout << "  " << physics.parameter_names[i] << ' '
                  << physics.column_scale[i] * physics.start.weights[i] << '\n';
    }
    if (const std::optional<double> sign_velocity = sign_velocity_of(physics.effects)) {
        std::cout << "dry friction: its sign is tanh(qd / " << *sign_velocity << ")\n";
    }
}

void print_torque_constants(const std::vector<TorqueGain>& gains) {
    const std::map<TorqueGain::Source, std::string> sources_of{
        {TorqueGain::Source::given, "given"},
        {TorqueGain::Source::estimated, "estimated"},
        {TorqueGain::Source::median, "median of the others"}};
    std::cout << "torque constants (N m/A):";
    std::string separator = " ";
    for (const TorqueGain& gain : gains) {
        std::cout << separator << 1 / gain.gain << " (" << sources_of.at(gain.source) << ')';
        separator = ", ";
    }
    std::cout << '\n';
}

void print_hold_out(const std::vector<HoldOutPoint>& points) {
    const HoldOutPoint& best = best_point(points);
    std::cout << "cross validation: least error " << best.error << " of the held-out variance, at ";
    if (best.length_scale > 0) {
        std::cout << "length scale " << best.length_scale << ", sigma^2/rho^2 " << best.noise_ratio;
    } else {
        std::cout << "gamma^2 " << best.prior_variance;
    }
    std::cout << (at_edge(best, points) ? ", at the edge of" : ", inside") << " a grid of " << points.size()
              << " points\n";
}

void print_kernel(const ModelTrainingResult& result) {
    const TrainedModel& model = result.model;
    std::cout << "features: input " << input_description(model.input.kind).name << ", length scale "
              << model.features.length_scale << ", rho^2/sigma^2 " << model.outputs.prior_variance << '\n';
    for (const std::string& sentence :
         bounds_reached(1 / model.outputs.prior_variance, model.features.length_scale)) {
        std::cout << "  " << sentence << '\n';
    }
    if (!result.held_joints.empty()) {
        std::cout << "  joints held in place, from whose motion nothing is learned: "
                  << counted_from_one(result.held_joints) << '\n';
    }
}

} // namespace

void print_outcome(const ModelTrainingResult& result, const std::string& trained_on) {
    const TrainedModel& model = result.model;
    const std::string& rows = model.training.rows;
    std::cout << "trained " << model.structure << " on " << trained_on << ", "
              << (rows == ":" ? "all rows" : "rows " + rows) << " (" << model.training.likelihood_rows
              << " in the exact kernel)\n";
    if (!result.hold_out.empty()) {
        print_hold_out(result.hold_out);
    } else if (!model.training.all_starts.empty()) {
        std::cout << "log likelihood per start:";
        for (const double value : model.training.all_starts) {
            std::cout << ' ' << value;
        }
        std::cout << '\n';
    }
    if (model.physics) {
        print_physics(*model.physics);
    }
    if (!result.torque_gains.empty()) {
        print_torque_constants(result.torque_gains);
    }
    if (structure_of(model).features) {
        print_kernel(result);
    }
    std::cout << "noise:";
    for (std::size_t k = 0; k < model.outputs.names.size(); ++k) {
        std::cout << ' ' << model.outputs.names[k] << ' ' << model.outputs.noise_std[k];
    }
    std::cout << '\n';
}

nlohmann::ordered_json outcome_json(const ModelTrainingResult& result, const Target& target) {
    const TrainedModel& model = result.model;
    nlohmann::ordered_json json{{"schema", "dfdyn.training/1"},
                                {"model", model.structure},
                                {"input", input_description(model.input.kind).name},
                                {"recordings", model.training.recordings},
                                {"rows", model.training.rows},
                                {"likelihood_rows", model.training.likelihood_rows},
                                {"log_likelihoods", model.training.all_starts},
                                {"physics", nlohmann::ordered_json::array()},
                                {"noise_std", nlohmann::ordered_json::object()},
                                {"footprint", footprint_json(model, target)}};
    if (!result.hold_out.empty()) {
        json["held_out_error"] = best_point(result.hold_out).error;
    }
    for (std::size_t i = 0; model.physics && i < model.physics->selected.size(); ++i) {
        json["physics"].push_back(
            {{"parameter", model.physics->parameter_names[i]},
             {"value", model.physics->column_scale[i] * model.physics->start.weights[i]}});
    }
    for (std::size_t k = 0; k < model.outputs.names.size(); ++k) {
        json["noise_std"][model.outputs.names[k]] = model.outputs.noise_std[k];
    }
    return json;
}

} // namespace dfdyn::tools
