// SPDX-License-Identifier: Apache-2.0
#include "tools/evaluation/opponents.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/small_model.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace opponents_test {

using namespace dfdyn::tools;
using dfdyn::tests::small_physics_model;

constexpr std::size_t ticks = 3000;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Two outputs that are an AR(2) with a mean of 3, predicted from tick 10 on as that mean.
ReplayedRecording autoregressive_outputs(std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    ReplayedRecording replayed;
    std::array<double, 2> last{}, before{};
    for (std::size_t tick = 0; tick < ticks; ++tick) {
        for (std::size_t k = 0; k < 2; ++k) {
            const double y = 1.6 * last[k] - 0.7 * before[k] + normal(engine);
            before[k] = last[k];
            last[k] = y;
            replayed.measured.push_back(y + 3);
            replayed.predicted.push_back(tick < 10 ? static_cast<float>(none) : 3.0F);
        }
        dfdyn::Status status;
        status.prediction = tick < 10 ? dfdyn::Reason::window_filling : dfdyn::Reason::ok;
        replayed.status.push_back(status);
    }
    return replayed;
}

TEST_CASE("persistence is the last measurement, whatever was missing in between") {
    ReplayedRecording replayed;
    replayed.measured = {1, 10, none, 20, 3, none, 4, 40};
    CHECK(persistence(replayed, 2) == Forecasts{0, 0, 1, 10, 1, 20, 3, 20});
}

TEST_CASE("the autoregression finds the coefficients, and uses nothing of its own tick") {
    DFDYN_SEEDED_ENGINE(engine);
    ReplayedRecording replayed = autoregressive_outputs(engine);
    const Forecasts forecasts = autoregression(replayed, 2);
    for (std::size_t tick = ticks / 2; tick < ticks; ++tick) {
        const double last = replayed.measured[2 * tick - 2];
        const double before = replayed.measured[2 * tick - 4];
        REQUIRE(forecasts[2 * tick] == Approx(3 + 1.6 * (last - 3) - 0.7 * (before - 3)).margin(0.6));
    }
    replayed.measured[2 * ticks - 2] = 1e6;
    CHECK(autoregression(replayed, 2) == forecasts);
    CHECK(persistence(replayed, 2)[2 * ticks - 2] == replayed.measured[2 * ticks - 4]);
}

TEST_CASE("opponents are judged at the ticks that the model predicted, and no others") {
    DFDYN_SEEDED_ENGINE(engine);
    const TrainedModel model = small_physics_model(engine, "P", InputKind::DFR, false);
    ReplayedRecording replayed = autoregressive_outputs(engine);
    const std::vector<OpponentErrors> errors = opponent_errors(replayed, model);
    REQUIRE(errors.size() == 3);
    const double state = errors[0].normalised_error[0];
    CHECK(state < errors[1].normalised_error[0]);
    CHECK(state < 1.1 * errors[2].normalised_error[0]);
    CHECK(errors[2].normalised_error[0] < errors[1].normalised_error[0]);
    for (std::size_t tick = 0; tick < 7; ++tick) { // not predicted, nor a forecast's last two values
        replayed.measured[2 * tick] += tick % 2 == 0 ? 1e-3 : -1e-3;
    }
    const std::vector<OpponentErrors> other = opponent_errors(replayed, model);
    CHECK(other[1].normalised_error == errors[1].normalised_error);
    replayed.predicted.assign(replayed.predicted.size(), std::nanf(""));
    CHECK(std::isnan(opponent_errors(replayed, model)[1].normalised_error[0]));
}

} // namespace opponents_test
