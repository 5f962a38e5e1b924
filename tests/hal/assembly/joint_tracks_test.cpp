// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/assembly/joint_tracks.hpp"

#include "tests/support/catch.hpp"

namespace joint_tracks_test {

using namespace dfdyn::hal;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t us = 1000;

TEST_CASE("a lost joint whose period is unknown is not explained by the jitter of the sensor") {
    const Range range{-3, 3};
    JointTracks<2, 16> joints({},
                              {.max_age_ns = 6 * ms,
                               .latency_ns = 0,
                               .qualification = {.readings = 10, .zero_readings = 1000},
                               .period_ns = 0, // unknown
                               .jitter_ns = 0},
                              {range, range}, {});
    Reason first = Reason::ok;
    Reason second = Reason::ok;
    const auto advance = [&](int from, int to, double off_rad) {
        for (int tick = from; tick < to; ++tick) {
            const auto value = [&](int joint, double position_rad) {
                JointValue one;
                one.joint = joint;
                one.stamp_ns = tick * 2 * ms;
                one.position_reason = Reason::ok;
                one.position_rad = position_rad;
                one.step_rad = 1e-5;
                one.from_zero_rad = position_rad + 2;
                return one;
            };
            joints.sensor_measured(tick * 2 * ms + tick % 2 * 10 * us, 2 * ms);
            first = joints.push(value(0, 0.1 + 1e-3 * tick + off_rad));
            second = joints.push(value(1, 0.2 + 1e-3 * tick));
        }
    };
    advance(0, 40, 0);
    CHECK(first == Reason::ok);
    advance(40, 60, 0.5);
    CHECK(first == Reason::position_lost);
    CHECK(joints[0].motion().lost());
    CHECK(second == Reason::ok);
}

} // namespace joint_tracks_test
