// SPDX-License-Identifier: Apache-2.0
// Limits of contacts that are measured during operation, against a batch computation of the same excesses.
#include "dfdyn/monitor/contact_calibration.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

namespace contact_calibration_test {

using Calibration = dfdyn::ContactCalibration<double, 2>;
using Detector = Calibration::Detector;
using dfdyn::JointMotion;

constexpr std::int64_t period_ns = 4'000'000;
constexpr std::int64_t settled_ns = 504'000'000; ///< stamp from which the detector counts
constexpr double any = 1e6;
constexpr dfdyn::ContactLimits<double> trained[2]{{{1, 1, 1}, 0.3, 0.1, any, any},
                                                  {{2, 2, 2}, 0.3, 0, any, any}};

/// Function of the time in seconds.
using Signal = std::function<double(double)>;

double still(double /*t*/) { return 0; }
double moving(double t) { return 0.5 * t; }

/// Moves for a second and rests for a second.
double resting(double t) {
    const double part = std::fmod(t, 2);
    return 0.5 * (std::floor(t / 2) + std::min(part, 1.0));
}

/// Error of `size` from 2 s until `end_s`.
Signal push(double size, double end_s) {
    return [=](double t) { return t >= 2 && t < end_s ? size : 0.0; };
}

/// A calibration with its detector. Both joints have the same motion.
struct Arm {
    Calibration calibration;
    Detector detector{{}, calibration.limits()};
    std::int64_t time_ns = 0;
    int repeats = 1;              ///< of each sample
    int contacts = 0;             ///< that have begun
    int contacts_afterwards = 0;  ///< of them after the calibration
    std::vector<double> excesses; ///< largest one of each second, in trained limits
    double second_excess = 0;

    explicit Arm(double duration_s, double rate_per_hour = 1)
        : calibration({}, trained, duration_s, rate_per_hour) {}

    double time_s() const { return 1e-9 * static_cast<double>(time_ns); }

    void run(double duration_s, const Signal& position, const Signal& first, const Signal& second = still) {
        const double end_s = time_s() + duration_s;
        while (time_s() < end_s) {
            time_ns += period_ns;
            const double q[2]{position(time_s()), position(time_s())};
            const double e[2]{first(time_s()), second(time_s())};
            for (int i = 0; i < repeats; ++i) {
                tick(q, e);
            }
        }
    }

    void tick(const double* q, const double* e) {
        constexpr double prediction[2]{0, 0};
        const bool before = detector.contact();
        const bool begins = detector.tick(time_ns, q, e, prediction, prediction) && !before;
        contacts += begins ? 1 : 0;
        contacts_afterwards += begins && calibration.finished() ? 1 : 0;
        second_excess =
            std::max(second_excess, detector.share(0) * calibration.factor(0, JointMotion::moving));
        calibration.tick(time_ns, detector);
        if (time_ns % 1'000'000'000 == settled_ns) {
            excesses.push_back(second_excess);
            second_excess = 0;
        }
    }
};

/// Pulses of 0.1 s in the middle of each second, with random sizes: `least` and an exponential part.
class Pulses {
  public:
    Pulses(std::mt19937_64& engine, double least, double mean)
        : engine_(engine), least_(least), mean_(mean) {}

    double operator()(double t) {
        if (const auto second = static_cast<long>(t); second != second_) {
            second_ = second;
            const double part = std::exponential_distribution<double>(1 / mean_)(engine_);
            size_ = (engine_() % 2 == 0 ? 1 : -1) * (least_ + part);
        }
        const double part = t - std::floor(t);
        return part > 0.7 && part < 0.8 ? size_ : 0;
    }

  private:
    std::mt19937_64& engine_;
    double least_, mean_;
    long second_ = -1;
    double size_ = 0;
};

TEST_CASE("an arm whose errors are below the model's limits keeps these limits", "[contacts]") {
    Arm arm(30);
    arm.repeats = GENERATE(1, 3);
    arm.run(32, moving, [](double t) { return 0.3 * std::sin(20 * t); });
    CHECK(arm.calibration.finished());
    for (int joint = 0; joint < 2; ++joint) {
        CHECK(arm.calibration.factor(joint, JointMotion::moving) == Approx(1));
        CHECK(arm.calibration.limits()[joint].relative == Approx(trained[joint].relative));
    }
}

TEST_CASE("during the calibration ten times the model's limit is a contact", "[contacts]") {
    const double size = GENERATE(5.0, 20.0);
    Arm arm(30);
    arm.run(4, moving, push(size, 2.5));
    CHECK(arm.contacts == (size > Calibration::calibration_factor ? 1 : 0));
    CHECK(arm.calibration.measuring());
}

TEST_CASE("neither collisions nor loads during the calibration are a part of the limits", "[contacts]") {
    const double end_s = GENERATE(2.5, 12.0, 1000.0); // after 3 s it counts as a load
    Arm arm(30);
    arm.run(60, moving, push(30, end_s));
    CHECK(arm.contacts >= 1);
    CHECK(arm.calibration.finished());
    CHECK(arm.calibration.factor(0, JointMotion::moving) < 1.5);
}

TEST_CASE("an arm that collides in every second is never calibrated", "[contacts]") {
    Arm arm(10);
    arm.run(100, moving, [](double t) { return t - std::floor(t) < 0.3 ? 40 : 0; });
    CHECK(arm.calibration.measuring());
    arm.calibration.abandon();
    CHECK(arm.calibration.abandoned());
    CHECK(arm.calibration.factor(0, JointMotion::moving) == 1);
    CHECK(arm.calibration.remaining_s() == 0);
}

TEST_CASE("time at rest neither counts nor changes the limits", "[contacts]") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::uint64_t seed = engine();
    double factors[2];
    for (const bool rests : {false, true}) {
        std::mt19937_64 pulses_engine(seed);
        Arm arm(60);
        arm.run(rests ? 3600 : 2, still, still);
        CHECK(arm.calibration.remaining_s() == Approx(60));
        Pulses pulses(pulses_engine, 1.5, 0.4);
        arm.run(62, moving, std::ref(pulses));
        REQUIRE(arm.calibration.finished());
        factors[rests ? 1 : 0] = arm.calibration.factor(0, JointMotion::moving);
    }
    CHECK(factors[1] == Approx(factors[0]).epsilon(0.05));
}

/// Returns the excess of a rate from all excesses of the second half, in units of the largest of the first.
double batch_factor(const std::vector<double>& excesses, std::size_t half, double rate_per_hour) {
    const double first = *std::max_element(excesses.begin(), excesses.begin() + static_cast<long>(half));
    std::vector<double> peaks(excesses.begin() + static_cast<long>(half), excesses.end());
    std::ranges::sort(peaks, std::greater{});
    const std::size_t tail = std::min<std::size_t>(peaks.size() / 2, 10);
    double mean = 0;
    for (std::size_t i = 0; i < tail; ++i) {
        mean += (peaks[i] - peaks[tail]) / first / static_cast<double>(tail);
    }
    constexpr double quantile_of_6 = 2.2041; // 10 %, chi-squared with 6 degrees of freedom: 3 exponentials
    mean *= tail == 3 ? 6 / quantile_of_6 : 1;
    const double per_hour = 3600 * static_cast<double>(tail) / static_cast<double>(peaks.size());
    return first * std::max(1.0, 1.08 * (peaks[tail] / first + mean * std::log(per_hour / rate_per_hour)));
}

TEST_CASE("the measured limits are those of all excesses in a batch", "[contacts]") {
    DFDYN_SEEDED_ENGINE(engine);
    const int half_s = GENERATE(6, 60);
    Arm arm(2 * half_s);
    Pulses pulses(engine, 1.5, half_s == 6 ? 0.1 : 0.3);
    arm.run(0.6, moving, still);
    arm.excesses.clear(); // that of the settling detector
    while (arm.calibration.measuring()) {
        arm.run(1, moving, std::ref(pulses));
    }
    REQUIRE(std::ssize(arm.excesses) == 2 * half_s);
    const double expected = batch_factor(arm.excesses, static_cast<std::size_t>(half_s), 1);
    REQUIRE(expected < Calibration::calibration_factor);
    CHECK(arm.calibration.factor(0, JointMotion::moving) == Approx(expected).epsilon(0.02));
    CHECK(arm.calibration.limits()[0].relative == Approx(0.1 * expected).epsilon(0.02));
    CHECK(arm.calibration.factor(0, JointMotion::changing) == // which did not occur
          Approx(arm.calibration.factor(0, JointMotion::moving)));
}

TEST_CASE("errors of several joints at once are no contacts after the calibration", "[contacts]") {
    const Signal pulse = [](double t) { return t - std::floor(t) < 0.1 ? 3 : 0; };
    Arm arm(60);
    arm.run(200, moving, pulse, [&](double t) { return 2 * pulse(t); });
    CHECK(arm.calibration.finished());
    CHECK(arm.contacts == 0);
}

TEST_CASE("errors at stops alone enlarge the limits for stops", "[contacts]") {
    Arm arm(30);
    arm.run(70, resting, [](double t) { return std::fmod(t, 2) > 1 && std::fmod(t, 2) < 1.1 ? 4 : 0; });
    REQUIRE(arm.calibration.finished());
    CHECK(arm.contacts == 0);
    const dfdyn::ContactLimits<double>& limits = arm.calibration.limits()[0];
    CHECK(arm.calibration.factor(0, JointMotion::changing) > 2);
    CHECK(arm.calibration.factor(0, JointMotion::moving) < 1.5);
    CHECK(limits.limit[0] >= limits.limit[1] / 2); // friction at standstill
}

TEST_CASE("contacts of exponential errors are at most twice as frequent as chosen", "[contacts]") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr double rate_per_hour = 30;
    int contacts = 0;
    constexpr int arms = 10;
    for (int i = 0; i < arms; ++i) {
        Arm arm(120, rate_per_hour);
        Pulses first(engine, 1.5, 0.4);
        Pulses second(engine, 3, 0.8);
        arm.run(1922, moving, std::ref(first), std::ref(second));
        REQUIRE(arm.calibration.finished());
        contacts += arm.contacts_afterwards;
    }
    CAPTURE(contacts);
    CHECK(contacts < 2 * rate_per_hour * arms / 2);
    CHECK(contacts > 0); // the limits are not merely large
}

TEST_CASE("interruptions and stamps out of order leave the measured limits finite", "[contacts]") {
    Arm arm(20);
    arm.run(5, moving, still);
    for (const std::int64_t stamp : {std::numeric_limits<std::int64_t>::max(), std::int64_t{0},
                                     std::numeric_limits<std::int64_t>::min(), arm.time_ns - 1}) {
        arm.calibration.tick(stamp, arm.detector); // while the detector runs
    }
    CHECK(arm.calibration.remaining_s() == Approx(16).margin(1));
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    constexpr double bad[2]{nan, nan};
    arm.tick(bad, bad);
    arm.run(20, moving, still);
    CHECK(arm.calibration.finished());
    CHECK(arm.calibration.factor(0, JointMotion::moving) == Approx(1));
}

TEST_CASE("an hour at ten kilohertz in float takes an hour", "[contacts]") {
    using Fast = dfdyn::ContactCalibration<float, 1>;
    constexpr dfdyn::ContactLimits<float> limits[1]{{{1, 1, 1}, 0.3F, 0, 1e6F, 1e6F}};
    Fast calibration({}, limits, 3600, 1);
    Fast::Detector detector({}, calibration.limits());
    constexpr std::int64_t ticks_per_hour = 36'000'000;
    constexpr float zero[1]{};
    std::int64_t tick = 0;
    for (; calibration.measuring() && tick < 2 * ticks_per_hour; ++tick) {
        const float q[1]{static_cast<float>(1e-4 * static_cast<double>(tick % 100'000))};
        detector.tick(tick * 100'000, q, zero, zero, zero);
        calibration.tick(tick * 100'000, detector);
    }
    CHECK(static_cast<double>(tick) == Approx(ticks_per_hour).epsilon(0.001));
}

} // namespace contact_calibration_test
