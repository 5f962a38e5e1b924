// SPDX-License-Identifier: Apache-2.0
#include "tools/sizing/model_needs.hpp"

#include "dfdyn/core/lag_window.hpp"
#include "dfdyn/learner/ud_covariance.hpp"
#include "tools/base/numerics/dynamic_storage.hpp"
#include "tools/base/text/number.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/model/run_time/runtime_estimator.hpp"
#include "tools/model/structure.hpp"

#include <cstdio>
#include <limits>

namespace dfdyn::tools {

namespace {

// Upper bounds for -O3 on a Cortex-M (docs/reference/performance.md).
constexpr std::int64_t code_bytes = 20 * 1024;
constexpr std::int64_t physics_code_bytes = 20 * 1024;
constexpr std::int64_t stack_bytes = 2 * 1024;
constexpr std::int64_t other_state_bytes = 1024; ///< counters, clock, outputs, alignment

constexpr std::int64_t number_bytes = sizeof(float);

std::int64_t count(const StartModel& start) {
    return static_cast<std::int64_t>(start.weights.size() + start.unit_upper.size() + start.diagonal.size());
}

std::int64_t count(const InputModel& input) {
    return static_cast<std::int64_t>(input.rows.size() + input.scale.size());
}

/// Returns the number of values in the constants of the physics.
std::int64_t count(const PhysicsModel& physics) {
    constexpr std::int64_t per_joint = 20;
    constexpr std::int64_t per_effect = 8;
    return per_joint * static_cast<std::int64_t>(physics.chain.joints.size() + 1) +
           per_effect * static_cast<std::int64_t>(physics.effects.size()) + count(physics.motion) +
           count(physics.start) +
           static_cast<std::int64_t>(physics.motion_limit.size() + 2 * physics.selected.size() +
                                     physics.output_gain.size() + physics.coupling.size());
}

std::int64_t window_bytes(const InputModel& input, int joints) {
    const bool derivatives = input_description(input.kind).uses_derivatives();
    const bool window = !derivatives || input.derivatives == Derivatives::estimated;
    const std::int64_t times = derivatives ? 2 : 0; // of each sample, 64 bits
    return window ? LagWindow<float, dynamic, dynamic>::state_bytes(joints, input.lags) +
                        times * number_bytes * (input.lags + 1)
                  : 0;
}

/// Number of the physics' parameters that are learned.
int learned_parameters(const TrainedModel& model) {
    const bool learned = model.physics && model.physics->prior_variance > 0;
    return learned ? static_cast<int>(model.physics->selected.size()) : 0;
}

/// Size of the learners' factors and weights; SPK's outputs have weights for each parameter.
std::int64_t learned_bytes(const TrainedModel& model) {
    using Learner = UdCovariance<float, dynamic, dynamic>;
    const auto outputs = static_cast<int>(model.outputs.names.size());
    const int parameters = learned_parameters(model);
    return Learner::state_bytes(2 * model.features.count, outputs * (1 + parameters)) +
           Learner::state_bytes(parameters, 1);
}

/// Number of columns of the regressions that a sample updates. The physics counts once for each output.
std::int64_t learned_columns(const TrainedModel& model) {
    return 2 * std::int64_t{model.features.count} +
           std::ssize(model.outputs.names) * learned_parameters(model);
}

/// Number of values of a tick in addition to the learned ones: inputs, features, rows of the physics.
std::int64_t work_numbers(const TrainedModel& model) {
    const auto outputs = static_cast<std::int64_t>(model.outputs.names.size());
    const std::int64_t inputs = std::int64_t{model.joints} * model.input.rows_per_joint;
    std::int64_t numbers = inputs + 4 * std::int64_t{model.features.count};
    if (model.physics) {
        const auto parameters = static_cast<std::int64_t>(model.physics->selected.size());
        numbers += 4 * outputs * (parameters + 8) + 60 * std::int64_t{model.joints};
    }
    return numbers;
}

} // namespace

ModelNeeds needs_of(const TrainedModel& model) {
    const auto estimator = make_estimator(model, true);
    const Cost cost = estimator->cost();
    ModelNeeds needs;
    const auto outputs = static_cast<std::int64_t>(model.outputs.names.size());
    const std::int64_t numbers = count(model.input) + static_cast<std::int64_t>(model.features.omega.size()) +
                                 count(model.start) + 3 * outputs + model.joints +
                                 (model.physics ? count(*model.physics) : 0);
    needs.flash_bytes = number_bytes * numbers + code_bytes + (model.physics ? physics_code_bytes : 0);
    needs.ram_bytes =
        learned_bytes(model) + number_bytes * work_numbers(model) + other_state_bytes + stack_bytes;
    needs.ram_bytes += structure_of(model).features ? window_bytes(model.input, model.joints) : 0;
    needs.ram_bytes += model.physics ? window_bytes(model.physics->motion, model.joints) : 0;
    needs.stack_bytes = stack_bytes;
    needs.predict_operations = cost.predict;
    needs.variance_operations = cost.variance;
    needs.learn_operations = cost.learn;
    needs.learned_columns = learned_columns(model);
    needs.forget_operations = model.forgetting_factor < 1 ? cost.forget : 0;
    needs.tick_operations = cost.predict + needs.learn_operations + needs.forget_operations;
    return needs;
}

TrainedModel with_feature_count(TrainedModel model, int feature_count) {
    if (!structure_of(model).features) {
        return model;
    }
    const auto columns = static_cast<std::size_t>(2 * feature_count);
    const std::size_t outputs = model.outputs.names.size();
    const auto inputs = static_cast<std::size_t>(model.joints * model.input.rows_per_joint);
    const bool coupled = model.physics && !model.physics->coupling.empty();
    model.features.count = feature_count;
    model.features.omega.assign(columns / 2 * inputs, 0);
    model.start = {std::vector<double>(outputs * columns), std::vector<double>(columns * (columns - 1) / 2),
                   std::vector<double>(columns, 1)};
    if (coupled) {
        model.physics->coupling.assign(outputs * model.physics->selected.size() * columns, 0);
    }
    return model;
}

namespace {

std::string byte_words(std::int64_t bytes) {
    return bytes < 1024 ? std::to_string(bytes) + (bytes == 1 ? " byte" : " bytes")
                        : number_text(static_cast<double>(bytes) / 1024) + " KiB";
}

std::string rounded_byte_words(std::int64_t bytes) {
    return bytes < 1024 ? byte_words(bytes) : number_text(kib_rounded_up(bytes)) + " KiB";
}

} // namespace

double kib_rounded_up(std::int64_t bytes) {
    return static_cast<double>((10 * bytes + 1023) / 1024) / 10; // in whole bytes: 24 KiB remain 24.0
}

bool fits(const ModelNeeds& needs, const TargetBudget& budget) {
    return needs.flash_bytes <= budget.flash_bytes && needs.ram_bytes <= budget.ram_bytes &&
           needs.tick_operations <= budget.tick_operations;
}

std::string excess_text(const ModelNeeds& needs, const TargetBudget& budget) {
    std::string text;
    const auto add = [&text](const char* what, const std::string& most, const std::string& found) {
        text.append(text.empty() ? "" : "; ")
            .append(std::string(what) + ": expected at most " + most + ", found " + found);
    };
    if (needs.flash_bytes > budget.flash_bytes) {
        add("flash", byte_words(budget.flash_bytes), rounded_byte_words(needs.flash_bytes));
    }
    if (needs.ram_bytes > budget.ram_bytes) {
        add("RAM", byte_words(budget.ram_bytes), rounded_byte_words(needs.ram_bytes));
    }
    if (needs.tick_operations > budget.tick_operations) {
        add("multiply-adds per tick", std::to_string(budget.tick_operations),
            std::to_string(needs.tick_operations));
    }
    return text;
}

std::string to_text(const TargetBudget& budget) {
    constexpr std::int64_t unlimited = std::numeric_limits<std::int64_t>::max();
    const auto kib = [](std::int64_t bytes) { return bytes == unlimited ? "unlimited" : byte_words(bytes); };
    return "flash " + kib(budget.flash_bytes) + ", RAM " + kib(budget.ram_bytes) + ", " +
           (budget.tick_operations == unlimited ? "unlimited" : std::to_string(budget.tick_operations)) +
           " multiply-adds per tick";
}

std::string to_text(const ModelNeeds& needs) {
    char text[120];
    std::snprintf(text, sizeof text, "flash %.1f KiB, RAM %.1f KiB, %lld multiply-adds per tick",
                  kib_rounded_up(needs.flash_bytes), kib_rounded_up(needs.ram_bytes),
                  static_cast<long long>(needs.tick_operations));
    return text;
}

} // namespace dfdyn::tools
