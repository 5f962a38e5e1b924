// SPDX-License-Identifier: Apache-2.0
#include "tools/sizing/size_choice.hpp"

#include "tests/support/catch.hpp"
#include "tools/base/recording/row_parts.hpp"
#include "tools/base/text/error.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>
#include <vector>

namespace size_choice_test {

using namespace dfdyn::tools;

/// A swinging joint whose torque has inertia, gravity and friction.
Recording swinging(int rows, double period_s) {
    std::mt19937_64 engine(1);
    std::normal_distribution<double> noise(0, 0.01);
    Recording recording;
    recording.source = "made up";
    recording.position.names = joint_names("q", 1);
    recording.output.names = output_names(OutputKind::joint_torque, 1);
    for (int row = 0; row < rows; ++row) {
        const double t = period_s * row;
        const double q = std::sin(2 * t) + 0.5 * std::sin(3.3 * t + 1);
        const double velocity = 2 * std::cos(2 * t) + 1.65 * std::cos(3.3 * t + 1);
        const double acceleration = -4 * std::sin(2 * t) - 5.445 * std::sin(3.3 * t + 1);
        recording.time_s.push_back(t);
        recording.time_ns.push_back(std::llround(1e9 * t));
        recording.gap_before.push_back(row == 0 ? 1 : 0);
        recording.position.values.push_back(q);
        recording.output.values.push_back(0.1 * acceleration + 2 * std::sin(q) + std::tanh(5 * velocity) +
                                          noise(engine));
    }
    return recording;
}

SizeChoice choose(const TargetBudget& budget, const FreeSizes& free = {}, double period_s = 0.01) {
    const Recording recording = swinging(static_cast<int>(15 / period_s), period_s);
    ModelTraining training;
    training.options.likelihood_rows = 80;
    training.options.evaluations_per_start = 30;
    training.options.feature_count = 16;
    return choose_sizes({&recording, 1}, OutputKind::joint_torque, training, free, budget);
}

TEST_CASE("the choice stays within the budget and a larger budget does not increase the error") {
    double error = 1e9;
    for (const std::int64_t operations : {2'000, 8'000, 40'000}) {
        TargetBudget budget;
        budget.tick_operations = operations;
        const SizeChoice choice = choose(budget);
        CHECK(fits(choice.chosen.needs, budget));
        CHECK(choice.chosen.error <= 1.02 * error);
        error = choice.chosen.error;
        if (choice.smaller) {
            CHECK(choice.smaller->needs.tick_operations < choice.chosen.needs.tick_operations);
        }
        if (choice.larger) {
            CHECK(choice.larger->needs.tick_operations > choice.chosen.needs.tick_operations);
        }
    }
}

TrainedModel trained_on(const Recording& recording) {
    ModelTraining training;
    training.options.likelihood_rows = 80;
    training.options.evaluations_per_start = 30;
    training.options.feature_count = 16;
    return train_model(prepare_training({&recording, 1}, training), OutputKind::joint_torque, training, {})
        .model;
}

TEST_CASE("every predicted row has the same weight in the held-out error, in recordings of any length") {
    Recording whole = swinging(1500, 0.01);
    const TrainedModel model = trained_on(whole);
    for (const std::size_t cut : {std::size_t{1000}, std::size_t{1498}}) { // two rows give no prediction
        CAPTURE(cut);
        whole.gap_before.assign(1500, 0);
        whole.gap_before[0] = whole.gap_before[cut] = 1;
        const double error = held_out_error(model, {&whole, 1});
        REQUIRE(error > 0);
        REQUIRE(error < 0.5);
        const std::vector<Recording> parts{rows_between(whole, 0, cut), rows_between(whole, cut, 1500)};
        CHECK(held_out_error(model, parts) == Approx(error).epsilon(1e-9));
    }
}

TEST_CASE("an output without a prediction has the held-out error 1, one that never changes has none") {
    const TrainedModel model = trained_on(swinging(1500, 0.01));
    Recording judged = swinging(2, 0.01);
    CHECK(held_out_error(model, {&judged, 1}) == 1);
    judged = swinging(300, 0.01);
    std::ranges::fill(judged.output.values, 2.5);
    CHECK(std::isinf(held_out_error(model, {&judged, 1})));
}

TEST_CASE("outputs that do not change at the end of the recording are rejected before training") {
    const int still = GENERATE(450, 400); // the last 450 rows judge, and the first ones have no prediction
    Recording recording = swinging(1500, 0.01);
    std::fill(recording.output.values.end() - still, recording.output.values.end(), 2.5);
    ModelTraining training;
    training.options.likelihood_rows = 80;
    training.options.evaluations_per_start = 30;
    training.options.feature_count = 16;
    if (still < 450) { // the others are before gaps
        for (std::size_t row = 1050; row < 1100; row += 5) {
            recording.gap_before[row] = 1;
        }
    }
    int candidates = 0;
    const auto choose_with = [&](const FreeSizes& free) {
        return choose_sizes({&recording, 1}, OutputKind::joint_torque, training, free, {},
                            [&] { ++candidates; });
    };
    CHECK_THROWS_WITH(
        choose_with({}),
        "made up: expected an output that changes in the last 30 % of the rows, by which models "
        "are compared, found none: record longer, with more varied motion");
    CHECK(candidates == (still < 450 ? 1 : 0));
    CHECK(choose_with({false, false, false, false}).chosen.options.feature_count == 16); // nothing to compare
}

TEST_CASE("a memory that is too short for more than 1000 features is not a candidate", "[.long]") {
    // At this period the shortest memory of the search is enough for 1000 features, but not for 1001.
    const Recording recording = swinging(80, 0.0025);
    ModelTraining training;
    training.options.likelihood_rows = 30;
    training.options.evaluations_per_start = 3;
    training.options.shrinkage = false;
    training.options.feature_count = 1001;
    const SizeChoice choice =
        choose_sizes({&recording, 1}, OutputKind::joint_torque, training, {false, false, false, true}, {});
    CHECK(choice.chosen.options.feature_count == 1001);
    CHECK(choice.tried == 3); // no memory, 30 s and 180 s
}

TEST_CASE("the rejection of constant outputs names the rows that the caller compares by") {
    Recording constant = swinging(10, 0.01);
    CHECK_NOTHROW(require_varying_outputs({&constant, 1}, "the rows from 49 % to 70 %"));
    std::ranges::fill(constant.output.values, 2.5);
    CHECK_THROWS_WITH(
        require_varying_outputs({&constant, 1}, "the rows from 49 % to 70 %"),
        Catch::Matchers::StartsWith(
            "made up: expected an output that changes in the rows from 49 % to 70 %, by which "));
}

TEST_CASE("a short memory limits the number of features that the choice considers") {
    const Recording recording = swinging(1500, 0.01);
    ModelTraining training;
    training.options.likelihood_rows = 80;
    training.options.evaluations_per_start = 30;
    const int most_features = GENERATE(10, 16, 40);
    CAPTURE(most_features);
    training.options.forgetting_factor = 1 - 1 / (2.2 * most_features);
    TargetBudget budget;
    budget.flash_bytes = 512 * 1024;
    const SizeChoice choice = choose_sizes({&recording, 1}, OutputKind::joint_torque, training,
                                           {false, false, true, false}, budget);
    REQUIRE_FALSE(choice.sizes.empty());
    CHECK(choice.sizes.back().features <= most_features);
    CHECK(choice.chosen.options.feature_count <= most_features);
}

TEST_CASE("equal data give equal choices") {
    TargetBudget budget;
    budget.ram_bytes = 16 * 1024;
    std::ostringstream first, second;
    print_choice(first, choose(budget), budget);
    print_choice(second, choose(budget), budget);
    CHECK(first.str() == second.str());
}

TEST_CASE("sizes given by the caller are kept") {
    TargetBudget budget;
    budget.tick_operations = 40'000;
    const TrainingOptions chosen = choose(budget, {false, false, false, false}).chosen.options;
    CHECK(chosen.lags == TrainingOptions().lags);
    CHECK(chosen.rows_per_joint == TrainingOptions().rows_per_joint);
    CHECK(chosen.feature_count == 16);
    CHECK(chosen.forgetting_factor == 1);
}

TEST_CASE("a budget too small for any model is rejected with the needs of the smallest") {
    TargetBudget budget;
    budget.ram_bytes = 1000;
    CHECK_THROWS_WITH(choose(budget),
                      Catch::Matchers::StartsWith("the budget (--flash, --ram, --tick-operations): expected "
                                                  "room for the smallest model, flash "));
}

} // namespace size_choice_test
