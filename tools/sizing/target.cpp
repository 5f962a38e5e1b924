// SPDX-License-Identifier: Apache-2.0
#include "tools/sizing/target.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/text.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace dfdyn::tools {

namespace {

/// Returns the records of models with fewer features than `model`, the largest first.
std::vector<SizeRecord> smaller_models(const TrainedModel& model) {
    std::vector<SizeRecord> smaller;
    std::ranges::copy_if(model.training.sizes, std::back_inserter(smaller),
                         [&](const SizeRecord& size) { return size.features < model.features.count; });
    std::ranges::sort(smaller, std::greater(), &SizeRecord::features);
    return smaller;
}

/// Returns the record of the model itself; nullptr if its size was not compared.
const SizeRecord* own_record(const TrainedModel& model) {
    const auto found = std::ranges::find(model.training.sizes, model.features.count, &SizeRecord::features);
    return found == model.training.sizes.end() ? nullptr : &*found;
}

/// Returns the instructions of the exponential functions of the extrapolation, in addition to their
/// multiply-adds: counted on models with 16 and 40 features on a Cortex-M7 (tests/start/start_project.sh).
std::int64_t extrapolation(const TrainedModel& model) {
    constexpr std::int64_t per_output = 480;
    return model.extrapolation ? per_output * static_cast<std::int64_t>(model.outputs.names.size()) : 0;
}

/// Returns the instructions of learning that are proportional to the number of columns, which the cost model
/// does not count. The factor is the smallest that suffices for the models of the table, plus 5 %.
std::int64_t of_columns(const ModelNeeds& needs) {
    constexpr std::int64_t per_column = 36;
    return per_column * needs.learned_columns;
}

void print_smaller(std::ostream& out, const TrainedModel& model) {
    const SizeRecord* const own = own_record(model);
    const std::vector<SizeRecord> smaller = smaller_models(model);
    if (own == nullptr || smaller.empty()) {
        return;
    }
    char text[160];
    std::snprintf(text, sizeof text, "smaller models (error on held-out rows; this model: %.3f):\n",
                  own->error);
    out << text;
    for (const SizeRecord& size : smaller) {
        std::snprintf(text, sizeof text,
                      "  %d features: flash %.1f KiB, RAM %.1f KiB, nRMSE %.3f (%+.1f %%)\n", size.features,
                      kib_rounded_up(size.flash_bytes), kib_rounded_up(size.ram_bytes), size.error,
                      100 * (size.error / own->error - 1));
        out << text;
    }
}

} // namespace

const std::vector<Target>& targets() {
    static const std::vector<Target> known{{"cortex-m7", 5.84, 2.68, 3.4},
                                           {"cortex-m7-double", 5.84, 2.68, 3.39},
                                           {"cortex-m4f", 5.94, 2.68, 3.36},
                                           {"cortex-m55", 5.56, 2.56, 3.25}};
    return known;
}

std::vector<std::string> target_names() {
    std::vector<std::string> names;
    std::ranges::transform(targets(), std::back_inserter(names), &Target::name);
    return names;
}

const Target& find_target(const std::string& name) {
    const auto found = std::ranges::find(targets(), name, &Target::name);
    if (found == targets().end()) {
        throw InputError("--target: expected one of " + listed(target_names()) + ", found " +
                         in_quotes(name) + suggestion(name, target_names()));
    }
    return *found;
}

TickInstructions instructions_of(const TrainedModel& model, const Target& target) {
    const ModelNeeds needs = needs_of(model);
    const auto count = [](double factor, std::int64_t operations) {
        return std::llround(factor * static_cast<double>(operations));
    };
    const std::int64_t predict = count(target.predict, needs.predict_operations) + extrapolation(model);
    const std::int64_t variance = count(target.variance, needs.variance_operations);
    const std::int64_t learn = count(target.learn, needs.learn_operations) + of_columns(needs);
    const std::int64_t forget = count(target.learn, needs.forget_operations);
    return {predict + variance, predict + learn, predict + variance + learn + forget};
}

void print_footprint(std::ostream& out, const TrainedModel& model, const Target& target) {
    const ModelNeeds needs = needs_of(model);
    const TickInstructions instructions = instructions_of(model, target);
    char text[240];
    std::snprintf(text, sizeof text,
                  "on %s: flash at most %.1f KiB, RAM at most %.1f KiB (of it stack %.1f KiB), about %lld "
                  "instructions per tick to predict and learn (largest tick %lld, predict only %lld)\n",
                  target.name.c_str(), kib_rounded_up(needs.flash_bytes), kib_rounded_up(needs.ram_bytes),
                  kib_rounded_up(needs.stack_bytes), static_cast<long long>(instructions.predict_and_learn),
                  static_cast<long long>(instructions.largest), static_cast<long long>(instructions.predict));
    out << text;
    print_smaller(out, model);
}

nlohmann::ordered_json footprint_json(const TrainedModel& model, const Target& target) {
    const ModelNeeds needs = needs_of(model);
    const TickInstructions instructions = instructions_of(model, target);
    nlohmann::ordered_json json{{"schema", "dfdyn.footprint/1"},
                                {"target", target.name},
                                {"flash_bytes", needs.flash_bytes},
                                {"ram_bytes", needs.ram_bytes},
                                {"stack_bytes", needs.stack_bytes},
                                {"tick_operations", needs.tick_operations},
                                {"instructions",
                                 {{"predict", instructions.predict},
                                  {"predict_and_learn", instructions.predict_and_learn},
                                  {"largest", instructions.largest}}},
                                {"smaller", nlohmann::ordered_json::array()}};
    if (const SizeRecord* const own = own_record(model)) {
        json["held_out_nrmse"] = own->error;
        for (const SizeRecord& size : smaller_models(model)) {
            json["smaller"].push_back({{"features", size.features},
                                       {"flash_bytes", size.flash_bytes},
                                       {"ram_bytes", size.ram_bytes},
                                       {"tick_operations", size.tick_operations},
                                       {"held_out_nrmse", size.error}});
        }
    }
    return json;
}

} // namespace dfdyn::tools
