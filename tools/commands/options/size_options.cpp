// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/size_options.hpp"

#include "tools/base/system/progress.hpp"
#include "tools/base/text/error.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/structure.hpp"

#include <algorithm>
#include <iostream>
#include <limits>

namespace dfdyn::tools {

namespace {

void copy_sizes(const TrainingOptions& from, TrainingOptions& to) {
    to.lags = from.lags;
    to.every = from.every;
    to.rows_per_joint = from.rows_per_joint;
    to.feature_count = from.feature_count;
    to.forgetting_factor = from.forgetting_factor;
}

} // namespace

void SizeOptions::add_to(CLI::App& command) {
    const char* const group = "Budget";
    command
        .add_option(
            "--flash", flash_bytes,
            "Bytes of flash for code, constants and the start of learning. A command that trains chooses "
            "window, k, d and memory by held-out error within --flash, --ram and --tick-operations, "
            "unless other options give them")
        ->transform(byte_count())
        ->type_name("BYTES[K|M]")
        ->group(group);
    command.add_option("--ram", ram_bytes, "Bytes of RAM for the estimator and the stack of a tick")
        ->transform(byte_count())
        ->type_name("BYTES[K|M]")
        ->group(group);
    command.add_option("--target", target, "Core whose instructions per tick are printed")
        ->check(one_of(target_names()))
        ->capture_default_str()
        ->group(group);
    command
        .add_option("--tick-operations", tick_operations,
                    "Multiply-adds of a tick that predicts and learns (docs/reference/performance.md has "
                    "instructions "
                    "and times of them)")
        ->check(whole_number_in(1, std::numeric_limits<std::int64_t>::max()))
        ->type_name("N")
        ->group(group);
}

TargetBudget SizeOptions::budget() const {
    TargetBudget budget;
    const auto bytes = [](std::uint64_t value) {
        return static_cast<std::int64_t>(
            std::min<std::uint64_t>(value, std::numeric_limits<std::int64_t>::max()));
    };
    budget.flash_bytes = flash_bytes ? bytes(*flash_bytes) : budget.flash_bytes;
    budget.ram_bytes = ram_bytes ? bytes(*ram_bytes) : budget.ram_bytes;
    budget.tick_operations = tick_operations.value_or(budget.tick_operations);
    return budget;
}

ModelTrainingResult train_within(const SizeOptions& sizes, const FreeSizes& free,
                                 std::span<const Recording> recordings, OutputKind outputs,
                                 ModelTraining& training, const ProgressCallback& progress) {
    const TargetBudget budget = sizes.budget();
    std::vector<SizeRecord> compared;
    {
        Progress line("choosing sizes: candidate", 0);
        std::size_t candidates = 0;
        const SizeChoice choice =
            choose_sizes(recordings, outputs, training, free, budget, [&] { line.update(++candidates); });
        copy_sizes(choice.chosen.options, training.options);
        print_choice(std::cout, choice, budget);
        compared = choice.sizes;
    }
    for (;;) {
        ModelTrainingResult result =
            train_model(prepare_training(recordings, training), outputs, training, progress);
        const ModelNeeds needs = needs_of(result.model);
        if (fits(needs, budget)) {
            std::cout << "the model takes at most " << to_text(needs) << '\n';
            result.model.training.sizes = std::move(compared);
            return result;
        }
        // With all rows, the physics may have more parameters than with the first 70 %.
        const int fewer = free.features ? next_smaller_features(training.options.feature_count) : 0;
        if (fewer == 0 || !structure_of(result.model).features) {
            throw InputError("the budget (--flash, --ram, --tick-operations): expected room for " +
                             to_text(needs) + ", found " + to_text(budget));
        }
        training.options.feature_count = fewer;
    }
}

} // namespace dfdyn::tools
