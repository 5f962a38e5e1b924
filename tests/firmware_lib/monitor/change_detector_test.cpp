// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/monitor/change_detector.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace change_detector_test {

using namespace dfdyn;

constexpr std::size_t outputs = 3;
constexpr double blocks_per_hour = 36000; // of 0.1 s

/// A disturbance added to the innovations.
struct Extra {
    double growth = 1, shift = 0, friction = 0, payload = 0, force = 0, burst = 0;
};

/// Block means of the innovations of an arm whose joints rest and move in turn. They are larger and slower at
/// rest, with a first-order autocorrelation from block to block. Their tails are normal, or those of
/// Student's t with four degrees of freedom.
template <class Scalar>
class Innovations {
  public:
    using Blocks = std::array<OutputBlock<Scalar>, outputs>;

    Innovations(double autocorrelation, bool heavy) : a_(autocorrelation), heavy_(heavy) {}

    /// Returns the next block, with `extra` on output 1, or on all outputs for extras that affect all.
    const Blocks& next(std::mt19937_64& engine, const Extra& extra = {}) {
        before_ = now_;
        ++block_;
        for (std::size_t k = 0; k < outputs; ++k) {
            const double velocity =
                std::sin(0.3 * block_ + 2 * static_cast<double>(k)) + 0.4 * std::sin(0.71 * block_);
            const bool stands = std::abs(velocity) < 0.15;
            const double fresh = heavy_ ? heavy_draw_(engine) : normal_(engine);
            state_[k] = a_ * state_[k] + std::sqrt(1 - a_ * a_) * fresh;
            OutputBlock<Scalar>& block = now_[k];
            block = {};
            block.deviation = 1;
            block.speed = static_cast<Scalar>(std::abs(velocity));
            block.friction[0] = static_cast<Scalar>(std::tanh(velocity / 0.02));
            block.payload[0] = static_cast<Scalar>(2 * std::cos(0.11 * block_ + 2 * static_cast<double>(k)));
            block.force[0] = static_cast<Scalar>(std::sin(0.9 * block_ + static_cast<double>(k)));
            const double own = k == 1 ? 1 : 0;
            const double noise = (stands ? 2 : 0.4) * state_[k] * (k == 1 ? extra.growth : 1);
            block.innovation = static_cast<Scalar>(
                noise + extra.burst * normal_(engine) +
                own * (extra.shift + extra.friction * static_cast<double>(block.friction[0])) +
                extra.payload * static_cast<double>(block.payload[0]) +
                extra.force * static_cast<double>(block.force[0]));
        }
        return now_;
    }
    const OutputBlock<Scalar>* before() const { return block_ > 1 ? before_.data() : nullptr; }

  private:
    double a_;
    bool heavy_;
    int block_ = 0;
    Blocks now_{}, before_{};
    std::array<double, outputs> state_{};
    std::normal_distribution<double> normal_;
    std::student_t_distribution<double> heavy_draw_{4};
};

template <class Scalar>
constexpr SpeedClasses<Scalar> speed{Scalar(0.05), Scalar(0.15)};

template <class Scalar>
using Detector = ChangeDetector<Scalar, outputs>;

template <class Scalar>
bool step(Detector<Scalar>& detector, Innovations<Scalar>& innovations, std::mt19937_64& engine,
          const Extra& extra = {}) {
    const auto& now = innovations.next(engine, extra);
    return detector.add(now.data(), innovations.before(), speed<Scalar>);
}

/// Counts the alarms that begin within a number of blocks.
template <class Scalar>
int alarms(Detector<Scalar>& detector, Innovations<Scalar>& innovations, int blocks,
           std::mt19937_64& engine) {
    int count = 0;
    for (int block = 0; block < blocks; ++block) {
        const bool before = detector.alarm();
        count += step(detector, innovations, engine) && !before ? 1 : 0;
    }
    return count;
}

TEMPLATE_TEST_CASE("white, coloured and heavy-tailed innovations raise no more false alarms than specified",
                   "[monitor]", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const bool heavy = GENERATE(false, true);
    const double autocorrelation = GENERATE(0.0, 0.6, 0.9);
    CAPTURE(heavy, autocorrelation);
    Innovations<TestType> innovations(autocorrelation, heavy);
    // One alarm in six minutes, so that some are likely to occur.
    Detector<TestType> detector({}, true, TestType(blocks_per_hour / 10));
    CHECK(alarms(detector, innovations, static_cast<int>(3 * blocks_per_hour), engine) <= 30);
}

TEMPLATE_TEST_CASE("every departure is detected with its onset, and ends", "[monitor]", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    const auto [kind, extra, channel] =
        GENERATE(table<Departure, Extra, int>({{Departure::growth, {.growth = 6}, 1},
                                               {Departure::shift, {.shift = 1.6}, 1},
                                               {Departure::friction, {.friction = -1.6}, 1},
                                               {Departure::payload, {.payload = 0.4}, 3},
                                               {Departure::force, {.force = 1.2}, 3},
                                               {Departure::burst, {.burst = 8}, 3}}));
    CAPTURE(static_cast<int>(kind));
    Innovations<TestType> innovations(0.3, false);
    Detector<TestType> detector({}, true, TestType(10 * blocks_per_hour));
    REQUIRE(alarms(detector, innovations, 2000, engine) == 0);
    int block = 0;
    while (block < 80 && !detector.alarm()) {
        step(detector, innovations, engine, extra);
        ++block;
    }
    CAPTURE(block);
    REQUIRE(detector.alarm());
    // Over one second the other kinds may look the same.
    if (kind == Departure::friction || kind == Departure::burst) {
        CHECK(static_cast<int>(detector.departure()) == static_cast<int>(kind));
        CHECK(detector.channel() == channel);
    }
    CHECK(detector.blocks_since_onset() >= block - 10); // earlier only if the sum happened to be above zero
    CHECK(detector.blocks_since_onset() <= block + 80);
    int over = 0;
    for (; over < 300 && detector.alarm(); ++over) {
        step(detector, innovations, engine);
    }
    CHECK(over < 150);
    CHECK(alarms(detector, innovations, 5000, engine) == 0);
}

TEST_CASE("a single block of any size raises no alarm", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    Innovations<float> innovations(0.3, false);
    Detector<float> detector({}, true, 10 * static_cast<float>(blocks_per_hour));
    REQUIRE(alarms(detector, innovations, 1000, engine) == 0);
    CHECK_FALSE(step(detector, innovations, engine, {.shift = 1e30}));
    CHECK(alarms(detector, innovations, 1000, engine) == 0);
}

/// Returns the blocks until the alarm of a payload that begins after 1,500 blocks. The first block of it or
/// one in the middle is absurd: all of its means are `spike`.
template <class Scalar>
int blocks_to_payload(std::optional<Scalar> spike, int at, std::mt19937_64 engine) {
    Innovations<Scalar> innovations(0.3, false);
    Detector<Scalar> detector({}, true, static_cast<Scalar>(10 * blocks_per_hour));
    std::array<OutputBlock<Scalar>, outputs> absurd{};
    bool follows = false;
    for (int block = 0; block < 2000; ++block) {
        auto now = innovations.next(engine, {.payload = block < 1500 ? 0 : 0.4});
        const auto* before = follows ? absurd.data() : innovations.before();
        follows = spike && block == at;
        if (follows) {
            for (OutputBlock<Scalar>& one : now) {
                one.innovation = one.payload[0] = one.force[0] = one.friction[0] = *spike;
            }
            absurd = now;
        }
        if (detector.add(now.data(), before, speed<Scalar>)) {
            return block - 1500;
        }
    }
    return 500;
}

TEMPLATE_TEST_CASE("an absurd block raises no alarm and hides no later change", "[monitor]", float, double) {
    DFDYN_SEEDED_ENGINE(engine);
    using Limits = std::numeric_limits<TestType>;
    const TestType spike =
        GENERATE(TestType(1e10), TestType(1e20), TestType(-1e30), Limits::max(), Limits::quiet_NaN());
    const int at = GENERATE(0, 100, 1000);
    CAPTURE(spike, at);
    const int usual = blocks_to_payload<TestType>({}, at, engine);
    REQUIRE(usual >= 0);
    const int found = blocks_to_payload<TestType>(spike, at, engine);
    CHECK(found >= 0);
    CHECK(found <= usual + 10);
}

/// An arm that rests for half a minute between motions of 2 s. At each stop the static friction of a joint
/// takes a new level within ±1 and relaxes over a second to a vibration of 0.01.
class Resting {
  public:
    using Blocks = std::array<OutputBlock<double>, outputs>;
    static constexpr int rest = 300, motion = 20; ///< blocks

    /// Returns the next block; `push` is a torque on all joints.
    const Blocks& next(std::mt19937_64& engine, double push = 0) {
        before_ = now_;
        const int phase = block_++ % (rest + motion);
        for (std::size_t k = 0; k < outputs; ++k) {
            OutputBlock<double>& block = now_[k];
            block = {};
            block.deviation = 0.3;
            block.speed = phase < motion ? 0.4 : 0;
            block.friction[0] = phase < motion ? 1 : 0;
            if (phase == motion) {
                friction_[k] = std::uniform_real_distribution<double>(-1, 1)(engine);
            }
            const double learned = std::exp(-(phase - motion) / 10.);
            const double stiction = phase < motion ? 0 : friction_[k] * learned * (1 - learned) * 4;
            const double noise = (phase < motion ? 0.1 : 0.01) * normal_(engine);
            block.innovation = (stiction + noise + push) / block.deviation;
        }
        return now_;
    }
    const OutputBlock<double>* before() const { return block_ > 1 ? before_.data() : nullptr; }

  private:
    int block_ = 0;
    Blocks now_{}, before_{};
    std::array<double, outputs> friction_{};
    std::normal_distribution<double> normal_;
};

TEST_CASE("stops at different levels of static friction raise no alarm but pushes do", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    Resting arm;
    Detector<double> detector({}, true, 10 * blocks_per_hour);
    for (int block = 0; block < 60 * (Resting::rest + Resting::motion); ++block) {
        const auto& now = arm.next(engine);
        REQUIRE_FALSE(detector.add(now.data(), arm.before(), speed<double>));
    }
    for (int block = 0; block < Resting::rest / 2; ++block) {
        const auto& now = arm.next(engine);
        REQUIRE_FALSE(detector.add(now.data(), arm.before(), speed<double>));
    }
    int pushed = 0; // in both directions, with four times the static friction
    bool alarm = false;
    while (pushed < 20 && !alarm) {
        const auto& now = arm.next(engine, 4 * std::sin(1.2 * ++pushed));
        alarm = detector.add(now.data(), arm.before(), speed<double>);
    }
    CHECK(pushed <= 8);
}

TEST_CASE("innovations far smaller than predicted raise no alarm", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    Innovations<double> innovations(0, false);
    std::array<OutputBlock<double>, outputs> now{};
    const auto alarm = [&](double least_scale, double shift) {
        Detector<double> detector({}, true, blocks_per_hour, least_scale);
        for (int block = 0; block < 1500; ++block) {
            now = innovations.next(engine);
            for (OutputBlock<double>& one : now) {
                one.innovation = one.innovation / 50 + (block > 1300 ? shift : 0); // noise of 0.01 to 0.04
            }
            if (detector.add(now.data(), nullptr, speed<double>)) {
                return true;
            }
        }
        return false;
    };
    CHECK_FALSE(alarm(0.3, 0.08));
    CHECK(alarm(0.3, 1));
    CHECK(alarm(1e-6, 0.08));
}

TEST_CASE("false alarms raise the limit of their kind", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    Innovations<double> innovations(0.3, false);
    Detector<double> detector({}, true, 10 * blocks_per_hour);
    alarms(detector, innovations, 2000, engine);
    while (!step(detector, innovations, engine, {.shift = 2})) {
    }
    const double limit = detector.limit(detector.departure());
    detector.report_false_alarm();
    detector.restart();
    step(detector, innovations, engine);
    CHECK(detector.limit(detector.departure()) > limit + 0.5);
}

TEST_CASE("a persistent level is adopted as the new reference", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    Innovations<double> innovations(0, false);
    Detector<double> detector({}, true, 10 * blocks_per_hour);
    REQUIRE(alarms(detector, innovations, 1000, engine) == 0);
    for (int block = 0; block < 50; ++block) {
        step(detector, innovations, engine, {.growth = 20});
    }
    REQUIRE(detector.alarm());
    detector.adopt();
    int alarmed = 0;
    for (int block = 0; block < 3000; ++block) {
        alarmed += step(detector, innovations, engine, {.growth = 20}) ? 1 : 0;
    }
    CHECK(alarmed == 0);
    CHECK(detector.noise(1).scale(2) == Approx(8).epsilon(0.2));
}

TEST_CASE("the block before a gap is ignored", "[monitor]") {
    DFDYN_SEEDED_ENGINE(engine);
    Innovations<double> innovations(0.9, false);
    Detector<double> detector({}, true, 10 * blocks_per_hour);
    int alarms = 0;
    for (int block = 0; block < 20000; ++block) {
        const auto& now = innovations.next(engine);
        const bool gap = block % 7 == 0;
        const bool alarm = detector.alarm();
        alarms +=
            detector.add(now.data(), gap ? nullptr : innovations.before(), speed<double>) && !alarm ? 1 : 0;
    }
    CHECK(alarms <= 1);
}

} // namespace change_detector_test
