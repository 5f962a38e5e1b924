// SPDX-License-Identifier: Apache-2.0
#include "tools/replay/opponents/opponents.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/support/small_model.hpp"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace opponents_test {

using namespace dfdyn::tools;
using dfdyn::tests::small_physics_model;

constexpr std::size_t ticks = 3000;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Two AR(2) outputs with mean 3; the predictions from tick 10 on are this mean.
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

TEST_CASE("persistence is the last measurement even after missing ones") {
    ReplayedRecording replayed;
    replayed.measured = {1, 10, none, 20, 3, none, 4, 40};
    CHECK(persistence(replayed, 2) == Forecasts{0, 0, 1, 10, 1, 20, 3, 20});
}

TEST_CASE("the autoregression finds the coefficients without the measurement of the same tick") {
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

/// Coefficients of [last value, value before, 1] from all samples before `tick`, with the prior.
Eigen::Vector3d batch_coefficients(const std::vector<double>& series, std::size_t tick) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Identity() * 1e-6;
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    for (std::size_t t = 2; t < tick; ++t) {
        const Eigen::Vector3d x(series[t - 1], series[t - 2], 1);
        information += x * x.transpose();
        right += x * series[t];
    }
    return information.ldlt().solve(right);
}

TEST_CASE("every forecast of the autoregression is the batch solution of the samples before it") {
    DFDYN_SEEDED_ENGINE(engine);
    const ReplayedRecording replayed = autoregressive_outputs(engine);
    const Forecasts forecasts = autoregression(replayed, 2);
    for (const std::size_t k : {0U, 1U}) {
        std::vector<double> series;
        for (std::size_t tick = 0; tick < ticks; ++tick) {
            series.push_back(replayed.measured[2 * tick + k]);
        }
        for (const std::size_t tick : {2U, 3U, 4U, 5U, 8U, 20U, 100U, 1000U, 2999U}) {
            CAPTURE(tick);
            const Eigen::Vector3d x(series[tick - 1], series[tick - 2], 1);
            REQUIRE(forecasts[2 * tick + k] ==
                    Approx(x.dot(batch_coefficients(series, tick))).epsilon(1e-5).margin(1e-5));
        }
    }
}

TEST_CASE("a forecast uses only earlier measurements and the next forecast uses the present one") {
    DFDYN_SEEDED_ENGINE(engine);
    const TrainedModel model = small_physics_model(engine, "P", InputKind::DFR, false);
    const ReplayedRecording replayed = autoregressive_outputs(engine);
    const auto check = [&](const char* name, const auto& forecasts_of) {
        const Forecasts forecasts = forecasts_of(replayed);
        for (const std::size_t tick : {12U, 100U, 1500U, 2998U}) {
            CAPTURE(name, tick);
            ReplayedRecording changed = replayed;
            for (std::size_t later = 2 * tick; later < changed.measured.size(); ++later) {
                changed.measured[later] += 1;
            }
            const Forecasts others = forecasts_of(changed);
            const auto next = static_cast<std::ptrdiff_t>(2 * (tick + 1));
            CHECK(std::equal(forecasts.begin(), forecasts.begin() + next, others.begin()));
            CHECK(forecasts[2 * tick + 2] != others[2 * tick + 2]);
            CHECK(forecasts[2 * tick + 3] != others[2 * tick + 3]);
        }
    };
    check("persistence", [](const ReplayedRecording& one) { return persistence(one, 2); });
    check("autoregression", [](const ReplayedRecording& one) { return autoregression(one, 2); });
    check("residual state", [&](const ReplayedRecording& one) { return with_residual_state(one, model); });
}

TEST_CASE("opponents are scored only at the ticks that the model predicted") {
    DFDYN_SEEDED_ENGINE(engine);
    const TrainedModel model = small_physics_model(engine, "P", InputKind::DFR, false);
    ReplayedRecording replayed = autoregressive_outputs(engine);
    const std::vector<OpponentErrors> errors = opponent_errors(replayed, model);
    REQUIRE(errors.size() == 5);
    CHECK(std::isnan(errors[3].normalised_error[0])); // no rigid body
    const double state = errors[0].normalised_error[0];
    CHECK(state < errors[1].normalised_error[0]);
    CHECK(state < 1.1 * errors[2].normalised_error[0]);
    CHECK(errors[2].normalised_error[0] < errors[1].normalised_error[0]);
    // No prediction belongs to these ticks, and no scored forecast uses their values.
    for (std::size_t tick = 0; tick < 7; ++tick) {
        replayed.measured[2 * tick] += tick % 2 == 0 ? 1e-3 : -1e-3;
    }
    const std::vector<OpponentErrors> other = opponent_errors(replayed, model);
    CHECK(other[1].normalised_error == errors[1].normalised_error);
    replayed.predicted.assign(replayed.predicted.size(), std::nanf(""));
    CHECK(std::isnan(opponent_errors(replayed, model)[1].normalised_error[0]));
}

} // namespace opponents_test
