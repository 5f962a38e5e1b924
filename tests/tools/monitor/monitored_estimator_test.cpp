// SPDX-License-Identifier: Apache-2.0
#include "tools/monitor/monitored_estimator.hpp"

#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/small_model.hpp"

#include <array>
#include <cmath>

namespace {

using namespace dfdyn::tools;
using dfdyn::Budget;
using dfdyn::tests::small_physics_model;

constexpr int ticks = 8000;

/// Samples of a motion and of noisy outputs that depend on it. The outputs have a sudden offset half way and
/// occasional faults, and the second one repeats its value in the last quarter.
class Samples {
  public:
    explicit Samples(std::size_t outputs) : outputs_(outputs) {}

    MeasuredSample next(std::mt19937_64& engine) {
        const double t = 0.004 * number_;
        std::normal_distribution<double> normal;
        position_ = {std::sin(3 * t), std::cos(5 * t)};
        for (std::size_t k = 0; k < outputs_; ++k) {
            if (k == 1 && 4 * number_ > 3 * ticks) {
                continue;
            }
            output_[k] = position_[0] * static_cast<double>(k) + position_[1] + 0.05 * normal(engine) +
                         (2 * number_ > ticks ? 1.5 : 0);
        }
        if (engine() % 200 == 0) {
            output_[0] = std::nan("");
        }
        number_ += engine() % 300 == 0 ? 9 : 1; // a gap
        return {std::int64_t{4000000} * number_, position_, position_, position_,
                std::span(output_).first(outputs_)};
    }

  private:
    std::size_t outputs_;
    int number_ = 0;
    std::array<double, 2> position_{};
    std::array<double, 6> output_{};
};

} // namespace

TEST_CASE("a monitor does not change predictions and learning", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    const bool wrench = GENERATE(false, true);
    const TrainedModel model = small_physics_model(engine, "SPK", InputKind::DFR, wrench);
    const auto plain = make_estimator(model, false);
    const auto watched = monitored(make_estimator(model, false), monitor_setup(model, nullptr, "test"));
    const std::int64_t share = plain->cost().learn / 3;
    Samples samples(model.outputs.names.size());
    for (int tick = 0; tick < ticks; ++tick) {
        const MeasuredSample sample = samples.next(engine);
        const Budget budget{engine() % 2 == 0 ? share : 10 * share};
        const Tick one = plain->tick(sample, budget);
        const Tick other = watched->tick(sample, budget);
        REQUIRE(one.status.prediction == other.status.prediction);
        REQUIRE(one.status.learning == other.status.learning);
        for (std::size_t k = 0; k < one.prediction.size(); ++k) {
            REQUIRE(one.prediction[k] == other.prediction[k]);
            REQUIRE(one.standard_deviation[k] == other.standard_deviation[k]);
        }
        REQUIRE(plain->advance({share}) == watched->advance({share}));
    }
    CHECK(plain->snapshot() == watched->snapshot());
}

TEST_CASE("findings of a monitor are stored without the heap until they are read", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    const TrainedModel model = small_physics_model(engine, "SPK", InputKind::DFR, false);
    const auto plain = make_estimator(model, false);
    const auto watched = monitored(make_estimator(model, false), monitor_setup(model, nullptr, "test"));
    Samples samples(model.outputs.names.size());
    std::uint64_t by_plain = 0, by_watched = 0, most = 0;
    for (int tick = 0; tick < ticks; ++tick) {
        const MeasuredSample sample = samples.next(engine);
        const dfdyn::tests::AllocationGuard guard;
        plain->tick(sample);
        const std::uint64_t alone = guard.calls().allocations;
        watched->tick(sample);
        const std::uint64_t with = guard.calls().allocations - alone;
        by_plain += alone;
        by_watched += with;
        most = std::max(most, with - std::min(with, alone));
    }
    CAPTURE(by_plain, by_watched);
    CHECK(most <= 1); // from a rigid body whose size is known only at run time, as in `plain`
    const std::size_t stored = watched->changes().size();
    REQUIRE(stored > 0); // at least the frozen output
    CHECK(watched->take_changes().size() == stored);
    CHECK(watched->changes().empty());
}
