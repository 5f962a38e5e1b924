// SPDX-License-Identifier: Apache-2.0
// All faults in random combinations.
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace estimator_fuzz_test {

using namespace dfdyn;
using namespace dfdyn::tests;

constexpr int lags = 5;
using FuzzModel = TestModel<float, DerivativeFreeReduced<lags, 2>, 4>;
using FuzzSample = FuzzModel::Sample;
constexpr float jump = 1e6F;
constexpr float position_limit = 1e7F;

/// Constants such that every jump of joint 1 makes the inputs invalid while it is in the window. All rows sum
/// to -1 without small entries and all frequencies are positive, so nothing cancels.
FuzzModel::Constants fuzz_constants(std::mt19937_64& engine) {
    FuzzModel::Constants constants{};
    std::uniform_real_distribution<float> size(0.5F, 1.5F);
    constants.identity = 1;
    constants.gap_ns = 3 * period_ns / 2;
    constants.period_ns = period_ns;
    for (int entry = 0; entry < constants.input.rows.size(); ++entry) {
        constants.input.rows[entry] = entry % (lags + 1) == 0 ? -1 : size(engine);
    }
    std::fill(constants.input.scale.begin(), constants.input.scale.end(), 1.0F);
    for (float& frequency : constants.features.frequencies) {
        frequency = size(engine);
    }
    constants.features.amplitude = 0.5F;
    constants.output_noise_std = {{0.05F, 0.08F}};
    constants.position_limit = {{position_limit, position_limit}};
    constants.output_limit = {{100, 100}};
    constants.innovation_limit = std::numeric_limits<float>::max();
    constants.learner = {1000, 0.999F, nullptr};
    return constants;
}

/// A second implementation of the documented rules for positions and time.
class Gates {
  public:
    Reason expect(const FuzzSample& sample) {
        for (const float position : sample.position) {
            if (!std::isfinite(position)) {
                return Reason::position_not_finite;
            }
            if (std::abs(position) > position_limit) {
                return Reason::position_out_of_range;
            }
        }
        Reason reason = Reason::window_filling;
        if (!window_.empty() && sample.time_ns <= last_ns_) {
            past_ = sample.time_ns < last_ns_ ? past_ + 1 : 0;
            if (past_ < 3) {
                return Reason::time_not_increasing;
            }
            window_.clear();
            clock_.restart();
            reason = Reason::clock_restarted;
        } else if (!window_.empty() &&
                   clock_.lost_before(static_cast<std::uint64_t>(sample.time_ns - last_ns_), period_ns)) {
            window_.clear();
            reason = Reason::gap;
        }
        past_ = 0;
        last_ns_ = sample.time_ns;
        window_.insert(window_.begin(), sample.position[0]);
        window_.resize(std::min<std::size_t>(window_.size(), lags + 1));
        if (window_.size() <= lags) {
            return reason;
        }
        const bool meaningless =
            std::any_of(window_.begin(), window_.end(), [](float q) { return std::abs(q) > jump / 2; });
        return meaningless ? Reason::input_out_of_range : Reason::ok;
    }

  private:
    std::vector<float> window_; ///< of joint 1, newest first
    SampleClock clock_;
    std::int64_t last_ns_ = 0;
    int past_ = 0;
};

Reason expected_learning(const FuzzSample& sample) {
    if (!sample.output_valid) {
        return Reason::output_missing;
    }
    for (const float output : sample.output) {
        if (!std::isfinite(output)) {
            return Reason::output_not_finite;
        }
        if (std::abs(output) > 100) {
            return Reason::output_out_of_range;
        }
    }
    return Reason::ok;
}

float not_finite(std::mt19937_64& engine) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    const float values[] = {std::numeric_limits<float>::quiet_NaN(), infinity, -infinity};
    return values[engine() % 3];
}

/// Replaces good samples by faulty ones, or adds them.
class FaultyLine {
  public:
    explicit FaultyLine(std::mt19937_64& engine) : engine_(&engine) {}

    /// Returns the samples that arrive for one good sample, in order. The good one, if it arrives, is the
    /// last.
    std::vector<FuzzSample> deliver(FuzzSample good) {
        good.time_ns += clock_ns_;
        std::vector<FuzzSample> arriving{good};
        if ((*engine_)() % 20 == 0) {
            damage(arriving);
        }
        last_ = arriving.empty() ? last_ : arriving.back();
        return arriving;
    }

  private:
    void damage(std::vector<FuzzSample>& arriving) {
        switch ((*engine_)() % 9) {
        case 0:
            arriving[0].position[joint()] = not_finite(*engine_);
            break;
        case 1:
            arriving[0].position[joint()] = -2 * position_limit;
            break;
        case 2:
            arriving[0].position[0] = jump;
            break;
        case 3:
            arriving[0].output[joint()] = not_finite(*engine_);
            break;
        case 4:
            arriving[0].output[joint()] = 1e9F;
            break;
        case 5:
            arriving[0].output_valid = false;
            break;
        case 6:
            arriving.clear();
            break;
        case 7:
            arriving.insert(arriving.begin(), 1 + (*engine_)() % 3, stray());
            break;
        default:
            set_clock();
            break;
        }
    }

    int joint() { return static_cast<int>((*engine_)() % 2); }

    /// Returns the last sample again, or a sample with a distant stamp.
    FuzzSample stray() {
        const std::int64_t offsets[] = {0, -10'000 * period_ns, 10'000 * period_ns, 1'000'000 * period_ns};
        FuzzSample sample = last_;
        sample.time_ns += offsets[(*engine_)() % 4];
        return sample;
    }

    void set_clock() {
        clock_ns_ = static_cast<std::int64_t>((*engine_)() % 2'000'000'000'000) - 1'000'000'000'000;
    }

    std::mt19937_64* engine_;
    std::int64_t clock_ns_ = 0;
    FuzzSample last_{};
};

/// An estimator at the end of a faulty line, checked in every tick.
class Victim {
  public:
    explicit Victim(const FuzzModel::Constants& constants)
        : estimator_(constants), learned_(snapshot_of(estimator_)) {}

    Estimator<FuzzModel>::Estimate tick(const FuzzSample& sample) {
        const Counters before = estimator_.counters();
        const auto estimate = estimator_.tick(sample, Budget::unlimited());
        const Reason prediction = gates_.expect(sample);
        REQUIRE(estimate.status.prediction == prediction);
        const bool predicted = prediction == Reason::ok;
        REQUIRE((!predicted || estimate.status.learning == expected_learning(sample)));
        check_counters(before, estimate.status);
        check_learned(estimate.status.learned());
        REQUIRE(std::isfinite(estimate.prediction[0] + estimate.prediction[1]));
        return estimate;
    }

    [[nodiscard]] const std::vector<std::byte>& learned() const { return learned_; }
    [[nodiscard]] const Counters& counters() const { return estimator_.counters(); }

  private:
    void check_counters(const Counters& before, const Status& status) {
        const Counters& after = estimator_.counters();
        REQUIRE(after.ticks == before.ticks + 1);
        REQUIRE(after.predicted == before.predicted + (status.predicted() ? 1 : 0));
        REQUIRE(after.learned == before.learned + (status.learned() ? 1 : 0));
        const auto reason = static_cast<int>(status.reason());
        REQUIRE(after.reasons[reason] == before.reasons[reason] + 1);
    }

    /// Checks that the learned state changes exactly in the ticks that report learning.
    void check_learned(bool changed) {
        auto now = snapshot_of(estimator_);
        REQUIRE((now != learned_) == changed);
        learned_ = std::move(now);
    }

    Estimator<FuzzModel> estimator_;
    Gates gates_;
    std::vector<std::byte> learned_;
};

/// Returns random bytes as a T.
template <class T>
T garbage(std::mt19937_64& engine) {
    const std::uint64_t bits = engine();
    T value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

FuzzSample garbage_sample(std::mt19937_64& engine) {
    FuzzSample sample{};
    sample.time_ns =
        engine() % 2 == 0 ? garbage<std::int64_t>(engine) : static_cast<std::int64_t>(engine() % 100);
    sample.output_valid = engine() % 2 == 0;
    for (int i = 0; i < 2; ++i) {
        sample.position[i] = garbage<float>(engine);
        sample.output[i] = garbage<float>(engine);
    }
    return sample;
}

// The twin receives every good sample, but learns only those that the victim learned. It must predict the
// same as the victim, bit for bit.
TEST_CASE("any mixture of faults is handled as documented and has no lasting effect") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = fuzz_constants(engine);
    Victim victim(constants);
    Estimator<FuzzModel> twin(constants);
    FaultyLine line(engine);
    int compared = 0;
    for (std::int64_t t = 0; victim.counters().ticks < 100'000; ++t) {
        FuzzSample good = moving_sample<FuzzModel>(t, engine);
        Estimator<FuzzModel>::Estimate last{};
        last.status.prediction = Reason::gap;
        for (const FuzzSample& sample : line.deliver(good)) {
            last = victim.tick(sample);
        }
        good.output_valid = last.status.learned();
        const auto expected = twin.tick(good, Budget::unlimited());
        if (last.status.predicted()) {
            REQUIRE(same(last.prediction, expected.prediction));
            ++compared;
        }
    }
    CHECK(compared > 30'000);
    CHECK((victim.learned() == snapshot_of(twin)));
    for (const Reason reason :
         {Reason::ok, Reason::window_filling, Reason::gap, Reason::clock_restarted, Reason::output_missing,
          Reason::position_not_finite, Reason::position_out_of_range, Reason::time_not_increasing,
          Reason::input_out_of_range, Reason::output_not_finite, Reason::output_out_of_range}) {
        CAPTURE(name(reason));
        CHECK(victim.counters().reasons[static_cast<int>(reason)] > 100);
    }
}

TEST_CASE("random bytes, budgets and calls leave a valid estimator") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants = fuzz_constants(engine);
    Estimator<FuzzModel> estimator(constants);
    for (int t = 0; t < 100'000; ++t) {
        const bool garbled = t % 1000 >= 500;
        const FuzzSample sample = garbled ? garbage_sample(engine) : moving_sample<FuzzModel>(t, engine);
        const auto estimate = estimator.tick(sample, Budget{static_cast<std::int64_t>(engine() % 1000)});
        REQUIRE(std::isfinite(estimate.prediction[0] + estimate.prediction[1]));
        REQUIRE(estimate.standard_deviation[0] > 0);
        REQUIRE(estimate.normalised_innovation_squared >= 0);
        if (t % 777 == 0) {
            const auto bytes = snapshot_of(estimator);
            REQUIRE(estimator.restore(bytes) == SnapshotResult::ok); // valid by the snapshot's own check
        }
    }
    CHECK(estimator.counters().learned > 1000);
}

} // namespace estimator_fuzz_test
