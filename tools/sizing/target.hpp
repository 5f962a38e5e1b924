// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/sizing/model_needs.hpp"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <ostream>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A processor core and its instructions per multiply-add of the cost model: a least-squares fit to the
/// counted instructions of the models of docs/reference/performance.md, plus 8 %. With the additional
/// instructions per column (`instructions_of`) this is an upper bound for every model of that table.
struct Target {
    std::string name;
    double predict = 0;  ///< of a prediction
    double variance = 0; ///< of the standard deviation apart from learning
    double learn = 0;    ///< of learning and forgetting
};

const std::vector<Target>& targets();

/// Returns their names, in the order of `targets`.
std::vector<std::string> target_names();

/// Returns the target with this name. Throws InputError for any other name.
const Target& find_target(const std::string& name);

/// Instructions of a tick; instructions are not cycles.
struct TickInstructions {
    std::int64_t predict = 0;           ///< a tick that predicts, with standard deviation, and does not learn
    std::int64_t predict_and_learn = 0; ///< a tick that also learns its sample completely
    /// the largest tick: one that contradicts the model, so that the standard deviation decides whether to
    /// learn, and that forgets
    std::int64_t largest = 0;
};

TickInstructions instructions_of(const TrainedModel& model, const Target& target);

/// Prints flash, RAM with stack, and instructions of `model` on `target`; then the smaller models that its
/// training compared, with their errors on held-out rows.
void print_footprint(std::ostream& out, const TrainedModel& model, const Target& target);

/// Returns the same figures as JSON, schema `dfdyn.footprint/1`.
nlohmann::ordered_json footprint_json(const TrainedModel& model, const Target& target);

} // namespace dfdyn::tools
