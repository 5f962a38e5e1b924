// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/monitor/joint_deviation.hpp"

#include "tests/support/catch.hpp"

#include <cmath>
#include <limits>

namespace joint_deviation_test {

using Joint = dfdyn::JointDeviation<double>;

constexpr dfdyn::ContactLimits<double> limits{{1, 1, 1}, 0.1, 0, 1e6, 1e6, 0.5};

const Joint::Steps steps(0.002);

/// Returns the factor on the limit after 20 s with this standard deviation of the predictions.
double doubt(double standard_deviation, const dfdyn::ContactLimits<double>& of = limits) {
    Joint joint;
    joint.reset(of);
    joint.begin(0, 0, 0);
    for (int tick = 0; tick < 10'000; ++tick) {
        joint.follow_doubt(standard_deviation, of, steps);
    }
    return joint.doubt();
}

TEST_CASE("a limit grows with the standard deviation of the prediction, at most four times", "[contacts]") {
    CHECK(doubt(0.5) == 1);
    CHECK(doubt(1.0) == Approx(2));
    CHECK(doubt(0.1) == 1); // never below the limit of the training
    CHECK(doubt(std::numeric_limits<double>::infinity()) == Approx(Joint::most_doubt));
    CHECK(doubt(std::numeric_limits<double>::quiet_NaN()) == 1);
    dfdyn::ContactLimits<double> unknown = limits; // of a model of an older version
    unknown.standard_deviation = 0;
    CHECK(doubt(1.0, unknown) == 1);
}

TEST_CASE("a limit hardly grows with the standard deviation of the first tenth of a second", "[contacts]") {
    Joint joint;
    joint.reset(limits);
    joint.begin(0, 0, 0);
    for (int tick = 0; tick < 50; ++tick) {
        joint.follow_doubt(1, limits, steps);
    }
    CHECK(joint.doubt() > 1);
    CHECK(joint.doubt() < 1.2);
}

/// Returns the deviation 0.2 s after a joint that moved forwards stops with this error. It had none before.
double deviation_at_rest(double error, double hysteresis) {
    dfdyn::ContactLimits<double> with = limits;
    with.hysteresis = hysteresis;
    Joint joint;
    joint.reset(with);
    joint.begin(0, 0, 0);
    double position = 0;
    for (int tick = 0; tick < 600; ++tick) {
        const bool moves = tick < 500;
        position += moves ? 0.001 : 0;
        joint.follow_motion(position, with, steps);
        joint.follow(moves ? 0 : error, 0, with, 1, false, steps);
    }
    return joint.deviation();
}

TEST_CASE("friction that a joint keeps at rest is no deviation, and a push against it is", "[contacts]") {
    CHECK(deviation_at_rest(0.5, 0) > 0.35); // the baseline follows a part
    CHECK(deviation_at_rest(0.5, 0.6) == 0);
    CHECK(deviation_at_rest(0.9, 0.6) > 0.15);
    CHECK(deviation_at_rest(0.9, 0.6) < 0.3);
    CHECK(deviation_at_rest(-0.5, 0.6) < -0.35);
}

TEST_CASE("the limit grows with deviations of a moving joint, and not with those at rest", "[contacts]") {
    const auto share_after = [](double velocity) {
        Joint joint;
        joint.reset(limits);
        joint.begin(0, 0, 0);
        double position = 0;
        for (int tick = 0; tick < 20'000; ++tick) {
            joint.follow_motion(position += velocity * steps.dt, limits, steps);
            joint.follow(tick / 100 % 2 == 0 ? 0.4 : -0.4, 0, limits, 1, false, steps);
        }
        return joint.share() / std::abs(joint.deviation());
    };
    CHECK(share_after(0) == Approx(1));
    CHECK(share_after(1) < 0.5);
}

} // namespace joint_deviation_test
