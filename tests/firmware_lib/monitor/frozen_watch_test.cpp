// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/monitor/frozen_watch.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <array>
#include <cmath>

namespace frozen_watch_test {

using namespace dfdyn;

constexpr int joints = 2;
constexpr int channels = 3;
constexpr double count_rad = 4e-4; ///< of the encoders

/// Two oscillating joints, the second with pauses, and a noisy output. Each reading can be frozen.
struct Readings {
    std::array<float, joints> position{};
    std::array<float, 1> output{};

    void move_to(double time_s, int frozen, std::mt19937_64& engine) {
        const double swing = std::sin(2 * time_s);
        const std::array<double, joints> angle{std::sin(1.3 * time_s), swing * swing * swing};
        for (std::size_t i = 0; i < joints; ++i) {
            if (frozen != static_cast<int>(i)) {
                position[i] = static_cast<float>(count_rad * std::round(angle[i] / count_rad));
            }
        }
        std::normal_distribution<double> noise(0, 0.1);
        if (frozen != joints) {
            output[0] = static_cast<float>(3 * static_cast<double>(position[0]) + noise(engine));
        }
    }
};

TEST_CASE("a reading that freezes while the arm moves is distinguished from one at rest", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    FrozenWatch<float, channels> watch({}, joints);
    Readings readings;
    int tick = 0;
    const auto run = [&](int ticks, int frozen) {
        float most = 0;
        for (int i = 0; i < ticks; ++i) {
            readings.move_to(0.01 * tick++, frozen, engine);
            watch.add(readings.position.data(), readings.output.data());
            for (int c = 0; c < channels; ++c) {
                most = std::max(most, c == frozen ? 0.0F : watch.evidence(c));
            }
        }
        return most;
    };
    run(1000, -1);
    CHECK(run(3000, -1) < 15); // the pauses of the second joint are not evidence
    const int frozen = GENERATE(0, 1, 2);
    CAPTURE(frozen);
    while (std::abs(std::sin(0.04 * tick)) < 0.7 ||
           std::cos(0.013 * tick) < 0.2) { // both joints are between their turning points
        run(1, -1);
    }
    CHECK(run(30, frozen) < 15);
    CHECK(watch.evidence(frozen) > 30);
    CHECK(watch.run(frozen) >= 25);
    run(100, -1);
    CHECK(watch.run(frozen) < 25);
}

TEST_CASE("repeated readings of an arm at standstill are not evidence", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    FrozenWatch<double, 2> watch({}, 2);
    for (int tick = 0; tick < 3000; ++tick) {
        const double phase = 0.01 * std::min(tick, 2000);
        const std::array<double, 2> position{std::sin(phase), std::cos(phase)};
        watch.add(position.data(), nullptr);
    }
    CHECK(watch.evidence(0) < 15);
    CHECK(watch.evidence(1) < 15);
}

TEST_CASE("a stationary joint that vibrates by a count is not frozen while the others move", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    FrozenWatch<float, 2> watch({}, 2);
    double phase = 0, tremble = 0;
    const auto run = [&](int ticks, bool first_moves, bool second_moves, bool trembles) {
        float most = 0;
        double rest = std::sin(1.7 * phase);
        for (int tick = 0; tick < ticks; ++tick) {
            phase += first_moves ? 0.01 : 0;
            rest = second_moves ? std::sin(1.7 * phase) : rest;
            tremble = trembles ? static_cast<double>(engine() % 2) : tremble;
            const auto count = [&](double angle) {
                return static_cast<float>(count_rad * (std::round(angle / count_rad) + tremble));
            };
            const std::array<float, 2> position{count(std::sin(phase)), count(rest)};
            watch.add(position.data(), nullptr);
            most = std::max(most, watch.evidence(1));
        }
        return most;
    };
    CHECK(run(3000, true, true, false) < 15);
    CHECK(run(60000, false, false, true) < 15); // ten minutes
    CHECK(run(300, true, false, false) < 15);
    run(1000, true, true, false);
    while (std::abs(std::cos(1.7 * phase)) < 0.7 || std::abs(std::cos(phase)) < 0.5) {
        run(1, true, true, false);
    }
    CHECK(run(600, true, false, false) > 15); // an abrupt stop
}

} // namespace frozen_watch_test
