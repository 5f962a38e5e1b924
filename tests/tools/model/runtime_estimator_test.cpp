// SPDX-License-Identifier: Apache-2.0
#include "tools/model/run_time/runtime_estimator.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/all_inputs.hpp"
#include "tests/tools/support/small_model.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/model/run_time/host_model.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <vector>

namespace {

using namespace dfdyn::tools;
using dfdyn::Physics;
using dfdyn::tests::small_model;
using dfdyn::tests::small_physics_model;

/// Runs the ticks `first` to `last` - 1 of a motion; returns the predictions of all of them.
std::vector<float> run(RuntimeEstimator& estimator, int first, int last) {
    std::vector<float> predictions;
    for (int tick = first; tick < last; ++tick) {
        const double t = 0.004 * tick;
        const std::array position{std::sin(3 * t), std::cos(5 * t)};
        std::array<double, 6> output{};
        for (std::size_t k = 0; k < 6; ++k) {
            output[k] = std::sin(3 * t) * static_cast<double>(k) + std::cos(5 * t);
        }
        const Tick result =
            estimator.tick({std::int64_t{4000000} * tick, position, position, position, output});
        predictions.insert(predictions.end(), result.prediction.begin(), result.prediction.end());
    }
    return predictions;
}

template <class Input, int lags, class... Effects>
std::vector<int> identities(std::type_identity<Physics<Input, lags, Effects...>>) {
    return {Effects::identity...};
}

} // namespace

TEST_CASE("each effect of the firmware has an identity of its own") {
    std::vector<int> all = identities(std::type_identity<HostPhysics>());
    std::ranges::sort(all);
    CHECK(std::ranges::adjacent_find(all) == all.end());
    CHECK(all.size() >= 7);
}

TEST_CASE("an estimator continues from its snapshot as it did when the snapshot was taken") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto kind = GENERATE(from_range(dfdyn::tests::all_inputs()));
    const std::string structure = GENERATE("NP", "P", "SP", "SPK");
    const TrainedModel model =
        structure == "NP" ? small_model(engine, kind) : small_physics_model(engine, structure, kind, true);
    CAPTURE(structure, input_description(kind).name);
    const auto estimator = make_estimator(model, false);
    run(*estimator, 0, 100);
    const std::vector<std::byte> snapshot = estimator->snapshot();
    CHECK(snapshot.size() == estimator->state_bytes());
    estimator->begin_recording();
    const std::vector<float> expected = run(*estimator, 200, 300);
    CHECK(std::ranges::any_of(expected, [](float value) { return value != 0; }));
    REQUIRE(estimator->restore(snapshot));
    CHECK(run(*estimator, 200, 300) == expected);
    const auto other = make_estimator(model, true);
    REQUIRE(other->restore(snapshot));
    CHECK(run(*other, 200, 300) == expected);
}

TEST_CASE("learning in slices gives the same result as learning at once") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::string structure = GENERATE("NP", "P", "SP", "SPK");
    const TrainedModel model = structure == "NP"
                                   ? small_model(engine, InputKind::DFR)
                                   : small_physics_model(engine, structure, InputKind::DFR, true);
    CAPTURE(structure);
    const auto at_once = make_estimator(model, true);
    const auto sliced = make_estimator(model, true);
    const dfdyn::Budget slice{sliced->cost().learn / 8 + sliced->cost().largest_step};
    int in_progress = 0;
    for (int tick = 0; tick < 100; ++tick) {
        const std::array position{std::sin(0.012 * tick), std::cos(0.02 * tick)};
        const std::array output{position[0], position[1], 1.0, 0.0, -position[0], 2.0};
        const MeasuredSample sample{std::int64_t{4000000} * tick, position, {}, {}, output};
        at_once->tick(sample);
        in_progress += sliced->tick(sample, slice).status.reason() == dfdyn::Reason::learning_in_progress;
        int slices = 0;
        while (!sliced->advance(slice)) {
            REQUIRE(++slices < 20);
        }
    }
    CHECK(in_progress > 50);
    CHECK(sliced->snapshot() == at_once->snapshot());
}

TEST_CASE("a snapshot of another model is rejected and changes nothing") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto estimator = make_estimator(small_model(engine, InputKind::DFR), false);
    const auto other = make_estimator(small_model(engine, InputKind::DFR), false);
    run(*estimator, 0, 50);
    const std::vector<std::byte> before = estimator->snapshot();
    CHECK_FALSE(estimator->restore(other->snapshot()));
    CHECK_FALSE(estimator->restore({}));
    CHECK(estimator->snapshot() == before);
}
