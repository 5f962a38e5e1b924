// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sizing/size_choice.hpp"
#include "tools/sizing/target.hpp"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace dfdyn::tools {

/// The options of `train` that set a budget, so that the program chooses the sizes.
struct SizeOptions {
    std::optional<std::uint64_t> flash_bytes, ram_bytes;
    std::optional<std::int64_t> tick_operations;
    std::string target = "cortex-m7";

    void add_to(CLI::App& command);

    bool given() const { return flash_bytes || ram_bytes || tick_operations; }
    TargetBudget budget() const;
};

/// Chooses the free sizes within the budget, prints the choice on stdout, and trains with it. Sets the sizes
/// in `training`. Throws InputError if nothing fits.
ModelTrainingResult train_within(const SizeOptions& sizes, const FreeSizes& free,
                                 std::span<const Recording> recordings, OutputKind outputs,
                                 ModelTraining& training, const ProgressCallback& progress);

} // namespace dfdyn::tools
