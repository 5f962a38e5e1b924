// SPDX-License-Identifier: Apache-2.0
#include "tools/sizing/size_choice.hpp"

#include "tools/base/recording/row_parts.hpp"
#include "tools/base/recording/sample_grid.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/replay/output_error.hpp"
#include "tools/replay/replay.hpp"
#include "tools/training/data/lag_spacing.hpp"
#include "tools/training/sign_velocity.hpp"
#include "tools/training/training_options.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace dfdyn::tools {

namespace {

constexpr double training_share = 0.7;
constexpr double same_error = 1.01;
constexpr std::array<int, 11> feature_counts{
    least_feature_count, 16, 25, 40, 63, 100, 160, 250, 400, 630, 1000};
constexpr int probe_features = 63; ///< largest number during the choice of window and rows
constexpr const char* judging_rows = "the last 30 % of the rows";
constexpr std::array<double, 4> windows_s{0.04, 0.08, 0.16, 0.32};
constexpr std::array<int, 3> row_counts{3, 4, 6};
constexpr std::array<double, 3> memories_s{5, 30, 180};

} // namespace

double held_out_error(const TrainedModel& model, std::span<const Recording> recordings) {
    const auto estimator = make_estimator(model, false);
    std::vector<OutputError> errors(model.outputs.names.size());
    for (const Recording& recording : recordings) {
        const ReplayedRecording replayed = replay(*estimator, {&model, 1}, recording, 0, [](std::size_t) {});
        for (std::size_t element = 0; element < replayed.predicted.size(); ++element) {
            errors[element % errors.size()].add(replayed.measured[element],
                                                static_cast<double>(replayed.predicted[element]));
        }
    }
    double total = 0;
    int known = 0; // an output that does not change has no error
    for (const OutputError& output : errors) {
        const double error = output.normalised();
        if (!std::isinf(error)) {
            total += std::isnan(error) ? 1 : error; // without a prediction: as good as a constant
            ++known;
        }
    }
    return known > 0 ? total / known : std::numeric_limits<double>::infinity();
}

namespace {

InputError nothing_to_judge(std::span<const Recording> judging, const std::string& rows) {
    return InputError(shown(judging.front().source) + ": expected an output that changes in " + rows +
                      ", by which models are compared, found none: record longer, with more varied motion");
}

/// Returns the largest number of features up to probe_features for which the memory is long enough; the
/// smallest one if there is none.
int largest_probe(double forgetting_factor) {
    int result = least_feature_count;
    for (const int count : feature_counts) {
        if (count <= probe_features && forgetting_factor >= least_forgetting_factor(count)) {
            result = count;
        }
    }
    return result;
}

} // namespace

void require_varying_outputs(std::span<const Recording> judging, const std::string& rows) {
    const std::vector<double>& first = judging.front().output.values;
    const std::size_t outputs = judging.front().output.names.size();
    for (const Recording& recording : judging) {
        for (std::size_t element = 0; element < recording.output.values.size(); ++element) {
            if (recording.output.values[element] != first[element % outputs]) {
                return;
            }
        }
    }
    throw nothing_to_judge(judging, rows);
}

namespace {

bool better(const SizeCandidate& a, const SizeCandidate& b) {
    if (a.needs.tick_operations <= b.needs.tick_operations) {
        return a.error <= same_error * b.error;
    }
    return same_error * a.error < b.error;
}

class SizeSearch {
  public:
    SizeSearch(std::span<const Recording> recordings, OutputKind outputs, const ModelTraining& training,
               const TargetBudget& budget, const std::function<void()>& on_candidate)
        : split_(split_recordings(recordings, training_share)), outputs_(outputs), training_(training),
          budget_(budget), on_candidate_(on_candidate), period_s_(sample_period_s(recordings)),
          probe_(largest_probe(training.options.forgetting_factor)) {
        if (training_.physics && !training_.physics->sign_velocity) {
            training_.physics->sign_velocity = usual_sign_velocity;
        }
        TrainingOptions& options = training_.options;
        options.starts = 1;
        options.likelihood_rows = std::min(options.likelihood_rows, 300);
        options.refinement_evaluations = 0;
    }

    SizeChoice run(const FreeSizes& free) {
        TrainingOptions options = training_.options;
        const bool chooses_rows = free.rows && input_description(options.input).chooses_rows;
        const bool chooses_features = free.features && options.model->features;
        const bool compares = free.window || chooses_rows || free.memory || chooses_features;
        if (compares) {
            require_varying_outputs(split_.judging, judging_rows);
        }
        if (free.features) {
            options.feature_count = probe_;
        }
        best_ = within_budget(options, free.features);
        if (compares && std::isinf(best_->error)) { // the outputs vary in rows without a prediction only
            throw nothing_to_judge(split_.judging, judging_rows);
        }
        if (free.window) {
            choose_window(free.features);
        }
        if (chooses_rows) {
            choose_rows(free.features);
        }
        if (free.memory) {
            choose_memory();
        }
        SizeChoice choice{*best_, {}, {}, {}, 0};
        if (chooses_features) {
            choose_features(choice);
        }
        choice.tried = tried_;
        return choice;
    }

  private:
    struct Trained {
        SizeCandidate candidate;
        TrainedModel model;
    };

    Trained trained(const TrainingOptions& options) {
        if (on_candidate_) {
            on_candidate_();
        }
        ++tried_;
        ModelTraining training = training_;
        training.options = options;
        Trained result;
        result.model = train_model(prepare_training(split_.training, training), outputs_, training, {}).model;
        result.model.limits.innovation = std::numeric_limits<float>::max();
        result.candidate = {options, period_s_ * options.lags * options.every, 0, needs_of(result.model),
                            held_out_error(result.model, split_.judging)};
        result.candidate.memory_s = memory_of(stored_forgetting_factor(options.forgetting_factor), period_s_);
        return result;
    }

    /// Returns the candidate with these options, with fewer features if the budget requires it; nothing if
    /// none fits.
    std::optional<SizeCandidate> fitting(TrainingOptions options, bool fewer_features) {
        for (;;) {
            Trained found = trained(options);
            model_ = std::move(found.model);
            if (fits(found.candidate.needs, budget_)) {
                return found.candidate;
            }
            smallest_ = found.candidate.needs;
            do {
                options.feature_count = fewer_features ? next_smaller_features(options.feature_count) : 0;
            } while (options.feature_count > 0 &&
                     !fits(needs_of(with_feature_count(model_, options.feature_count)), budget_) &&
                     next_smaller_features(options.feature_count) > 0);
            if (options.feature_count == 0) {
                return {};
            }
        }
    }

    SizeCandidate within_budget(const TrainingOptions& options, bool fewer_features) {
        const auto found = fitting(options, fewer_features);
        if (!found) {
            throw InputError("the budget (--flash, --ram, --tick-operations): expected room for the smallest "
                             "model, " +
                             to_text(smallest_) + ", found " + to_text(budget_));
        }
        return *found;
    }

    void consider(const TrainingOptions& options, bool fewer_features) {
        const auto found = fitting(options, fewer_features);
        if (found && better(*found, *best_)) {
            best_ = found;
        }
    }

    void choose_window(bool fewer_features) {
        const TrainingOptions base = best_->options;
        const int most_lags = most_window_lags(base);
        for (const double window_s : windows_s) {
            TrainingOptions options = base;
            const LagSpacing spacing = spacing_of(window_s, period_s_, most_lags);
            options.lags = spacing.lags;
            options.every = spacing.every;
            const bool same = options.lags == base.lags && options.every == base.every;
            if (!same && options.lags + 1 >= options.rows_per_joint &&
                dense_lags(spacing) <= largest_lag_count) {
                consider(options, fewer_features);
            }
        }
    }

    void choose_rows(bool fewer_features) {
        const TrainingOptions base = best_->options;
        for (const int rows : row_counts) {
            TrainingOptions options = base;
            options.rows_per_joint = rows;
            if (rows != base.rows_per_joint && rows <= base.lags + 1) {
                consider(options, fewer_features);
            }
        }
    }

    void choose_memory() {
        const TrainingOptions base = best_->options;
        for (const double memory_s : memories_s) {
            TrainingOptions options = base;
            options.forgetting_factor = forgetting_factor_of(memory_s, period_s_);
            const int most_features = std::max(base.feature_count, feature_counts.back());
            if (options.forgetting_factor >= least_forgetting_factor(most_features)) {
                consider(options, false);
            }
        }
    }

    /// Chooses the largest number of features that fits, unless a smaller one is equally good; also sets its
    /// neighbours.
    void choose_features(SizeChoice& choice) {
        std::vector<SizeCandidate> ladder;
        for (const int count : feature_counts) {
            TrainingOptions options = best_->options;
            options.feature_count = count;
            if (options.forgetting_factor < least_forgetting_factor(count)) {
                break; // the memory is too short for more features
            }
            const bool fitting_size = fits(needs_of(with_feature_count(model_, count)), budget_);
            if (!fitting_size && !ladder.empty() && !fits(ladder.back().needs, budget_)) {
                break; // one candidate beyond the budget is shown
            }
            if (count < probe_ / 4 && fits(needs_of(with_feature_count(model_, probe_)), budget_)) {
                continue;
            }
            ladder.push_back(trained(options).candidate);
            if (ladder.size() >= 3 && ladder.back().error * same_error > ladder[ladder.size() - 2].error &&
                ladder[ladder.size() - 2].error * same_error > ladder[ladder.size() - 3].error) {
                break; // two steps without an improvement
            }
        }
        for (const SizeCandidate& one : ladder) {
            choice.sizes.push_back({one.options.feature_count, one.needs.flash_bytes, one.needs.ram_bytes,
                                    one.needs.tick_operations, one.error});
        }
        std::size_t best = 0;
        for (std::size_t rung = 1; rung < ladder.size(); ++rung) {
            if (fits(ladder[rung].needs, budget_) &&
                (!fits(ladder[best].needs, budget_) || better(ladder[rung], ladder[best]))) {
                best = rung;
            }
        }
        choice.chosen = ladder[best];
        choice.smaller = best > 0 ? std::optional(ladder[best - 1]) : std::nullopt;
        choice.larger = best + 1 < ladder.size() ? std::optional(ladder[best + 1]) : std::nullopt;
    }

    SplitRecordings split_;
    OutputKind outputs_;
    ModelTraining training_;
    TargetBudget budget_;
    const std::function<void()>& on_candidate_;
    double period_s_;
    int probe_; ///< number of features during the choice of window and rows
    std::optional<SizeCandidate> best_;
    TrainedModel model_; ///< the last model trained: its physics has the right sizes
    ModelNeeds smallest_;
    int tried_ = 0;
};

void print_row(std::ostream& out, const char* name, const SizeCandidate& one, bool fitting) {
    char text[200];
    std::snprintf(text, sizeof text,
                  "  %-8s window %.3g s (%d lags, %d samples apart), k %d, d %d, memory %s, %s, held-out "
                  "nRMSE %.3f%s\n",
                  name, one.window_s, one.options.lags, one.options.every, one.options.rows_per_joint,
                  one.options.feature_count,
                  one.memory_s > 0 ? (number_text(std::round(one.memory_s)) + " s").c_str() : "unlimited",
                  to_text(one.needs).c_str(), one.error, fitting ? "" : " (beyond the budget)");
    out << text;
}

} // namespace

int next_smaller_features(int feature_count) {
    const auto next = std::ranges::lower_bound(feature_counts, feature_count);
    return next == feature_counts.begin() ? 0 : *(next - 1);
}

SizeChoice choose_sizes(std::span<const Recording> recordings, OutputKind outputs,
                        const ModelTraining& training, const FreeSizes& free, const TargetBudget& budget,
                        const std::function<void()>& on_candidate) {
    return SizeSearch(recordings, outputs, training, budget, on_candidate).run(free);
}

void print_choice(std::ostream& out, const SizeChoice& choice, const TargetBudget& budget) {
    out << "sizes: " << choice.tried
        << " candidates, trained on the first 70 % of the rows, evaluated on the rest\n";
    if (choice.smaller) {
        print_row(out, "smaller", *choice.smaller, fits(choice.smaller->needs, budget));
    }
    print_row(out, "chosen", choice.chosen, true);
    if (choice.larger) {
        print_row(out, "larger", *choice.larger, fits(choice.larger->needs, budget));
    }
}

} // namespace dfdyn::tools
