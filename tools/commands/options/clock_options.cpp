// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/clock_options.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/sizing/size_choice.hpp"
#include "tools/training/data/lag_spacing.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <string>

namespace dfdyn::tools {

namespace {

LagSpacing spacing(const ClockOptions& options, int most_lags, double period_s) {
    if (options.lags) {
        return {*options.lags, options.every.value_or(1)};
    }
    const double window_s = options.window_s.value_or(ClockOptions::default_window_s);
    if (window_s > largest_lag_count * period_s) {
        throw InputError("--window: expected at most " + std::to_string(largest_lag_count) +
                         " sample periods, " + number_text(largest_lag_count * period_s) + " s, found " +
                         number_text(window_s) + " s");
    }
    if (options.every) {
        const double lags = std::round(window_s / (period_s * *options.every));
        return {std::max(least_window_lags, static_cast<int>(lags)), *options.every};
    }
    return spacing_of(window_s, period_s, most_lags);
}

/// Throws InputError if the learner has fewer samples in memory than it has weights, those of the smallest
/// model if a budget chooses the number of features.
void check_memory(double memory_s, TrainingOptions training, double period_s, bool free_features) {
    training.feature_count = free_features ? least_feature_count : training.feature_count;
    const double least = least_forgetting_factor(training);
    if (training.forgetting_factor < least) {
        const double samples = std::round(1 / (1 - least));
        throw InputError("--memory: expected at least " + number_text(samples * period_s) + " s (2 samples" +
                         (training.model->features ? " per feature" : "") + " at " +
                         rounded_text(1 / period_s) + " Hz" +
                         (training.model->features && free_features
                              ? ", with " + std::to_string(least_feature_count) + " features"
                              : "") +
                         "), found " + number_text(memory_s) + " s");
    }
}

} // namespace

void ClockOptions::add_to(CLI::App& command) {
    CLI::Option* const window =
        command
            .add_option("--window", window_s,
                        "Time that the last positions cover (s); lags follow from the recording's sample "
                        "period. Without --window and --lags: 0.08")
            ->check(positive_number())
            ->type_name("S");
    command.add_option("--lags", lags, "M: the window holds M+1 positions per joint, instead of --window")
        ->check(whole_number_in(1, largest_lag_count))
        ->excludes(window);
    command
        .add_option("--every", every,
                    "Lags are N samples apart, each the mean of N positions; every sample is still "
                    "predicted and learned. Default: as many as leave at most 20 lags, 1 with --lags, input "
                    "STD and --hyper CV")
        ->check(whole_number_in(1, largest_lag_count))
        ->type_name("N");
    CLI::Option* const memory =
        command
            .add_option("--memory", memory_s,
                        "Time after which a sample weighs 1/e of a new one (s): the forgetting factor is "
                        "exp(-period / S). Without --memory and --forgetting nothing is forgotten")
            ->check(positive_number())
            ->type_name("S");
    command
        .add_option("--forgetting", forgetting_factor,
                    "Forgetting factor of the learner per sample, instead of --memory; 1: none")
        ->check(number_in(0, 1))
        ->excludes(memory);
}

void ClockOptions::apply(TrainingOptions& training, double period_s, bool free_features) const {
    const LagSpacing chosen = spacing(*this, most_window_lags(training), period_s);
    training.lags = chosen.lags;
    training.every = chosen.every;
    if (forgetting_factor) {
        training.forgetting_factor = *forgetting_factor;
    } else if (memory_s) {
        training.forgetting_factor = forgetting_factor_of(*memory_s, period_s);
        check_memory(*memory_s, training, period_s, free_features);
    }
}

std::string describe_clock(const TrainingOptions& training, double period_s) {
    constexpr double same_memory = 0.01;
    const double wanted = training.forgetting_factor;
    const double stored = stored_forgetting_factor(wanted);
    const double wanted_s = memory_of(wanted, period_s);
    const double stored_s = memory_of(stored, period_s);
    std::ostringstream text;
    text << std::setprecision(4) << "sample period " << period_s << " s, window "
         << period_s * training.lags * training.every << " s (" << training.lags << " lags, "
         << training.every << (training.every == 1 ? " sample" : " samples") << " apart), memory ";
    if (std::abs(stored_s - wanted_s) > same_memory * wanted_s) {
        text << (stored < 1 ? number_text(std::round(stored_s)) + " s" : "unlimited") << " (" << wanted_s
             << " s rounded to single precision)";
    } else if (wanted < 1) {
        text << wanted_s << " s";
    } else {
        text << "unlimited";
    }
    return text.str();
}

} // namespace dfdyn::tools
