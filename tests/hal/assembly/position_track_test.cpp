// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/assembly/position_track.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>

namespace position_track_test {

using namespace dfdyn::hal;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t latency = ms / 4;
constexpr double speed = 0.5; // rad/s

/// Returns the position of a joint at constant velocity.
double at(std::int64_t time_ns) { return 0.3 + speed * 1e-9 * static_cast<double>(time_ns); }

/// A track with a period of 2 ms, and its joint.
struct Joint {
    PositionTrack<16> track{{.max_age_ns = 6 * ms,
                             .latency_ns = latency,
                             .qualification = {},
                             .period_ns = 2 * ms,
                             .jitter_ns = ms / 4},
                            {-3, 3},
                            {}};

    /// Passes the position of `time_ns` with an error of `off_rad`, in a frame that comes `latency` later.
    Reason push(std::int64_t time_ns, double off_rad = 0, Reason reason = Reason::ok) {
        JointValue value;
        value.joint = 0;
        value.stamp_ns = time_ns + latency;
        value.position_reason = reason;
        value.position_rad = at(time_ns) + off_rad;
        value.step_rad = 1e-5;
        value.from_zero_rad = value.position_rad;
        return track.push(value);
    }
    Reason reason_at(std::int64_t instant_ns, std::int64_t now_ns) {
        return track.at(instant_ns, now_ns).reason;
    }
};

/// Returns a trusted joint with its last reading at 40 ms.
Joint moving() {
    Joint joint;
    for (std::int64_t time_ns = 0; time_ns <= 40 * ms; time_ns += 2 * ms) {
        const Reason reason = joint.push(time_ns);
        CHECK(reason == (time_ns < 18 * ms ? Reason::qualifying : Reason::ok)); // ten readings
    }
    return joint;
}

TEST_CASE("a position between two readings is interpolated at the time of measurement") {
    Joint joint = moving();
    const Measurement<1> measured = joint.track.at(33 * ms, 41 * ms);
    CHECK(measured.reason == Reason::ok);
    CHECK(measured.value[0] == Approx(at(33 * ms)).epsilon(1e-12));
    CHECK(joint.track.origin(33 * ms) == ValueOrigin::interpolated);
    CHECK(joint.track.newest_ns() == 40 * ms);
}

TEST_CASE("a position that is not due is held; one that was due is missing until it is interpolated") {
    Joint joint = moving();
    CHECK(joint.track.at(41 * ms, 41 * ms).value[0] == at(40 * ms));
    CHECK(joint.track.origin(41 * ms) == ValueOrigin::held);
    CHECK(joint.reason_at(43 * ms, 43 * ms) == Reason::position_missing);
    CHECK(joint.track.pending(43 * ms, 43 * ms));
    CHECK(joint.push(44 * ms) == Reason::ok); // the one of 42 ms was lost
    CHECK_FALSE(joint.track.pending(43 * ms, 45 * ms));
    CHECK(joint.track.at(43 * ms, 45 * ms).value[0] == Approx(at(43 * ms)).epsilon(1e-12));
    CHECK(joint.track.origin(43 * ms) == ValueOrigin::bridged);
}

TEST_CASE("there is no interpolation across a position that the motion excludes") {
    Joint joint = moving();
    CHECK(joint.push(42 * ms, 0.2) == Reason::position_jump);
    CHECK(joint.push(44 * ms) == Reason::ok);
    CHECK(joint.reason_at(41 * ms, 45 * ms) == Reason::position_jump);
    CHECK(joint.reason_at(43 * ms, 45 * ms) == Reason::position_jump);
    CHECK(joint.push(46 * ms) == Reason::ok);
    CHECK(joint.reason_at(45 * ms, 47 * ms) == Reason::ok);
}

TEST_CASE("two different positions with one stamp are both rejected") {
    Joint joint = moving();
    CHECK(joint.push(40 * ms, 0.2) == Reason::time_not_increasing);
    CHECK(joint.reason_at(40 * ms, 41 * ms) == Reason::time_not_increasing);
    CHECK(joint.track.not_later() == 1);
}

TEST_CASE("a position that is repeated with its stamp stays valid, also in another turn of its integer") {
    constexpr double turn_rad = 6.283185307179586;
    PositionTrack<16> track{{.max_age_ns = 6 * ms,
                             .latency_ns = latency,
                             .qualification = {},
                             .period_ns = 2 * ms,
                             .jitter_ns = ms / 4},
                            {4, 9},
                            {}};
    JointValue value;
    value.position_reason = Reason::ok;
    value.step_rad = 1e-5;
    value.wrap_rad = turn_rad;
    value.from_zero_rad = 100;
    for (std::int64_t time_ns = 0; time_ns <= 40 * ms; time_ns += 2 * ms) {
        value.stamp_ns = time_ns + latency;
        value.position_rad = at(time_ns); // 6.28 rad less than the joint's
        track.push(value);
    }
    REQUIRE(track.at(40 * ms, 41 * ms).reason == Reason::ok);
    CHECK(track.push(value) == Reason::time_not_increasing);
    CHECK(track.not_later() == 1);
    CHECK(track.at(40 * ms, 41 * ms).reason == Reason::ok);
    CHECK(track.at(40 * ms, 41 * ms).value[0] == Approx(at(40 * ms) + turn_rad));
}

TEST_CASE("a second sender of a joint is detected by its rate, with any values") {
    Joint joint = moving();
    int collisions = 0;
    for (std::int64_t time_ns = 42 * ms; time_ns < 60 * ms; time_ns += 2 * ms) {
        collisions += joint.push(time_ns) == Reason::id_collision ? 1 : 0;
        collisions += joint.push(time_ns + ms) == Reason::id_collision ? 1 : 0;
    }
    CHECK(collisions >= 14);
    CHECK(joint.track.collisions() >= 7);
}

TEST_CASE("a device fault requires new qualification; an answer to an unknown SYNC does not") {
    Joint unknown = moving();
    CHECK(unknown.push(42 * ms, 0, Reason::sync_unknown) == Reason::sync_unknown);
    CHECK(unknown.push(44 * ms) == Reason::ok);
    Joint restarted = moving();
    CHECK(restarted.push(42 * ms, 0, Reason::device_restarted) == Reason::device_restarted);
    CHECK(restarted.push(44 * ms) == Reason::qualifying);
}

TEST_CASE("after a stall of the reader a moving joint is trusted again within twelve readings") {
    for (const std::int64_t stall_ms : {8, 12, 30, 100}) {
        Joint joint = moving();
        const std::int64_t read_ns = (40 + stall_ms) * ms + ms / 5;
        for (std::int64_t late = 2; late <= stall_ms; late += 2) { // read together, not when they were sent
            const std::int64_t stamp_ns = read_ns + late * ms / 100;
            const double off_rad = at((40 + late) * ms) - at(stamp_ns);
            CHECK(joint.push(stamp_ns, off_rad) != Reason::ok);
        }
        int refused = 0;
        for (std::int64_t time_ns = (42 + stall_ms) * ms; time_ns < (200 + stall_ms) * ms;
             time_ns += 2 * ms) {
            refused += joint.push(time_ns) == Reason::ok ? 0 : 1;
        }
        CAPTURE(stall_ms, refused);
        CHECK(refused <= 12); // ten, and two until the first of those read together is out
    }
}

TEST_CASE("a joint whose velocity shows that its position is frozen is not trusted") {
    PositionTrack<16> track{{.max_age_ns = 6 * ms,
                             .latency_ns = 0,
                             .qualification = {.readings = 10, .zero_readings = 1000},
                             .period_ns = 2 * ms,
                             .jitter_ns = ms / 4},
                            {-3, 3},
                            {}};
    const auto push = [&](std::int64_t time_ns, double position_rad, double velocity) {
        JointValue value;
        value.stamp_ns = time_ns;
        value.position_reason = Reason::ok;
        value.position_rad = value.from_zero_rad = position_rad;
        value.step_rad = 1e-5;
        value.has_velocity = true;
        value.velocity = velocity;
        return track.push(value);
    };
    std::int64_t time_ns = 0;
    double position_rad = 0.1;
    double velocity = 0;
    const auto move = [&](double wanted, int ticks, bool frozen = false) {
        Reason last = Reason::ok;
        const double sent_rad = position_rad;
        for (int tick = 0; tick < ticks; ++tick) {
            time_ns += 2 * ms;
            velocity += std::clamp(wanted - velocity, -0.01, 0.01);
            position_rad += 2e-3 * velocity;
            last = push(time_ns, frozen ? sent_rad : position_rad, velocity);
        }
        return last;
    };
    CHECK(move(0.5, 1500) == Reason::ok);
    CHECK(move(-0.5, 1500) == Reason::ok);
    CHECK(move(0, 200) == Reason::ok);
    CHECK(move(0.5, 250, true) == Reason::velocity_contradicts);
    CHECK(move(0.5, 1000) == Reason::ok); // no longer frozen
}

} // namespace position_track_test
