// SPDX-License-Identifier: Apache-2.0
#include "tools/training/training_options.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/model/structure.hpp"
#include "tools/training/data/lag_spacing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

namespace dfdyn::tools {
namespace {

template <class Value>
using Name = std::pair<std::string_view, Value>;

constexpr std::array<Name<PriorForm>, 3> prior_names{
    {{"scaled", PriorForm::scaled}, {"unit", PriorForm::unit}, {"diagonal", PriorForm::diagonal}}};
constexpr std::array<Name<HyperMethod>, 2> method_names{{{"ML", HyperMethod::ML}, {"CV", HyperMethod::CV}}};

template <class Names>
auto named(const Names& names, const std::string& what, const std::string& name) {
    std::string known;
    for (const auto& [text, value] : names) {
        if (text == name) {
            return value;
        }
        known.append(known.empty() ? "" : ", ").append(text);
    }
    throw InputError(what + ": expected one of " + known + ", found " + in_quotes(name));
}

constexpr int likelihood_rows_least = 20;

void expect(bool condition, const std::string& what, const std::string& found) {
    if (!condition) {
        throw InputError("training options: expected " + what + ", found " + found);
    }
}

void expect(bool condition, const std::string& what, double found) {
    expect(condition, what, number_text(found));
}

void check_lags(const TrainingOptions& options) {
    const InputDescription& input = input_description(options.input);
    const bool physics = options.model->has_physics() && !input.uses_derivatives();
    const int least = physics ? std::max(2, input.least_lags) : input.least_lags;
    expect(options.lags >= least, "at least " + std::to_string(least) + " lags", options.lags);
    if (input.chooses_rows) {
        expect(options.rows_per_joint >= 1 && options.rows_per_joint <= options.lags + 1,
               "1 to lags + 1 rows per joint", options.rows_per_joint);
    }
    expect(options.every >= 1, "lags at least 1 sample apart", options.every);
    if (options.every > 1) {
        expect(!input.uses_derivatives(), std::string("lags one sample apart for input ") + input.name,
               options.every);
        expect(options.hyper != HyperMethod::CV, "lags one sample apart for cross validation", options.every);
    }
    const int samples = dense_lags({options.lags, options.every});
    expect(samples <= largest_lag_count,
           "a window of at most " + std::to_string(largest_lag_count) + " samples", samples);
}

void check_search(const TrainingOptions& options) {
    expect(options.feature_count >= 1, "at least 1 random feature", options.feature_count);
    expect(options.likelihood_rows >= likelihood_rows_least, "at least 20 likelihood rows",
           options.likelihood_rows);
    expect(options.starts >= 1, "at least 1 start", options.starts);
    expect(options.evaluations_per_start >= 1, "at least 1 evaluation per start",
           options.evaluations_per_start);
    expect(options.refinement_evaluations >= 0, "at least 0 evaluations of the refinement",
           options.refinement_evaluations);
    expect(options.threads >= 1, "at least 1 thread", options.threads);
    const double least = least_forgetting_factor(options);
    expect(options.forgetting_factor >= least && options.forgetting_factor <= 1,
           std::string("a forgetting factor from ") +
               (options.model->features ? "1 - 1/(2 features) = " : "") + std::to_string(least) + " to 1",
           options.forgetting_factor);
}

/// Returns `A, B or C`: the names of the entries of a catalogue that `fits` accepts.
template <class Catalogue, class Condition>
std::string names_where(const Catalogue& catalogue, Condition fits) {
    std::vector<std::string> names;
    for (const auto* const entry : catalogue) {
        if (fits(*entry)) {
            names.emplace_back(entry->name);
        }
    }
    const std::string last = names.back();
    names.pop_back();
    return names.empty() ? last : listed(names) + " or " + last;
}

void check_hold_out(const TrainingOptions& options) {
    expect(!options.model->fits_jointly(),
           "model " +
               names_where(all_structures(), [](const Structure& one) { return !one.fits_jointly(); }) +
               " for cross validation",
           std::string(options.model->name));
    const InputDescription& input = input_description(options.input);
    expect(
        input.cross_validation,
        "input " +
            names_where(input_catalogue(), [](const InputDescription& one) { return one.cross_validation; }) +
            " for cross validation",
        std::string(input.name));
    expect(options.training_share > 0 && options.training_share < 1, "a training share between 0 and 1",
           options.training_share);
}

void check_physics(const TrainingOptions& options, const TrainingData& data) {
    const PhysicsOptions& physics = options.physics;
    expect(physics.regressor != nullptr, std::string("a robot's physics for model ") + options.model->name,
           "none");
    const auto outputs = static_cast<double>(physics.regressor->outputs());
    expect(physics.regressor->outputs() == data.outputs.cols(),
           "physics of " + std::to_string(data.outputs.cols()) + " outputs", outputs);
    expect(physics.column_threshold > 0 && physics.column_threshold < 1,
           "a threshold of the columns between 0 and 1", physics.column_threshold);
    if (input_description(options.input).chooses_rows && physics.motion == PhysicsMotion::of_input) {
        expect(options.rows_per_joint >= 3, "at least 3 rows per joint for the physics to share",
               options.rows_per_joint);
    }
    if (physics.given) {
        expect(options.model->physics == PhysicsRole::fixed_first,
               std::string("model ") + structures::SP2.name + " for given parameters",
               std::string(options.model->name));
        expect(physics.given->size() == physics.regressor->columns() && physics.given->allFinite(),
               std::to_string(physics.regressor->columns()) + " finite physical parameters",
               static_cast<double>(physics.given->size()));
    }
}

} // namespace

PriorForm parse_prior_form(const std::string& name) { return named(prior_names, "--prior", name); }

HyperMethod parse_hyper_method(const std::string& name) { return named(method_names, "--hyper", name); }

int most_window_lags(const TrainingOptions& options) {
    const bool contiguous =
        input_description(options.input).uses_derivatives() || options.hyper == HyperMethod::CV;
    return contiguous ? largest_lag_count : most_spaced_lags;
}

double forgetting_factor_of(double memory_s, double period_s) { return std::exp(-period_s / memory_s); }

double memory_of(double forgetting_factor, double period_s) {
    return forgetting_factor < 1 ? -period_s / std::log(forgetting_factor) : 0;
}

double stored_forgetting_factor(double forgetting_factor) {
    return static_cast<double>(static_cast<float>(forgetting_factor));
}

double least_forgetting_factor(const TrainingOptions& options) {
    return options.model->features ? least_forgetting_factor(options.feature_count) : 0.5;
}

void check_options(const TrainingOptions& options, const TrainingData& data) {
    check_lags(options);
    check_search(options);
    if (options.hyper == HyperMethod::CV) {
        check_hold_out(options);
    }
    if (options.model->has_physics()) {
        check_physics(options, data);
    }
}

} // namespace dfdyn::tools
