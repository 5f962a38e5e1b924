// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/clock_options.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/commands/options/value_checks.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/training/data/lag_spacing.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace dfdyn::tools {

namespace {

constexpr int least_lags = 2;

LagSpacing spacing(const ClockOptions& options, bool contiguous, double period_s) {
    if (options.lags) {
        return {*options.lags, options.every.value_or(1)};
    }
    const double window_s = options.window_s.value_or(ClockOptions::default_window_s);
    if (window_s > largest_lag_count * period_s) {
        throw InputError("--window: expected at most " + std::to_string(largest_lag_count) +
                         " sample periods, " + number_text(largest_lag_count * period_s) + " s, found " +
                         number_text(window_s) + " s");
    }
    if (options.every || contiguous) {
        const int every = options.every.value_or(1);
        const double lags = std::round(window_s / (period_s * every));
        return {std::max(least_lags, static_cast<int>(lags)), every};
    }
    return spacing_of(window_s, period_s, least_lags);
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

void ClockOptions::apply(TrainingOptions& training, double period_s) const {
    const bool contiguous =
        input_description(training.input).uses_derivatives() || training.hyper == HyperMethod::CV;
    const LagSpacing chosen = spacing(*this, contiguous, period_s);
    training.lags = chosen.lags;
    training.every = chosen.every;
    if (forgetting_factor) {
        training.forgetting_factor = *forgetting_factor;
    } else if (memory_s) {
        training.forgetting_factor = std::exp(-period_s / *memory_s);
    }
}

std::string describe_clock(const TrainingOptions& training, double period_s) {
    const double lambda = training.forgetting_factor;
    std::ostringstream text;
    text << std::setprecision(4) << "sample period " << period_s << " s, window "
         << period_s * training.lags * training.every << " s (" << training.lags << " lags, "
         << training.every << (training.every == 1 ? " sample" : " samples") << " apart), memory ";
    if (lambda < 1) {
        text << -period_s / std::log(lambda) << " s";
    } else {
        text << "unlimited";
    }
    return text.str();
}

} // namespace dfdyn::tools
