// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/assembly/track.hpp"

#include "tests/support/catch.hpp"

namespace track_test {

using namespace dfdyn::hal;

using Joint = Track<1, 4>;

/// Values are held for 15 ns; frames come 2 ns after the measurement; three readings qualify.
Joint make_joint() { return {{15, 2, {3, 10}}, {{{-1, 1}}}, position_reasons}; }

/// Returns a qualified track with 0.1 at 10, 0.2 at 20, 0.3 at 30 and 0.4 at 40.
Joint ready_joint() {
    Joint joint = make_joint();
    for (int i = -2; i <= 4; ++i) {
        joint.push(10 * i + 2, Reason::ok, {0.1 * i}, false);
    }
    return joint;
}

TEST_CASE("a value is measured, interpolated or held at the sample time") {
    Joint joint = ready_joint();
    CHECK(joint.at(30, 30).value[0] == Approx(0.3));
    CHECK(joint.at(30, 30).stamp_ns == 30);
    CHECK(joint.at(35, 35).value[0] == Approx(0.35));
    CHECK(joint.at(35, 35).stamp_ns == 40);
    CHECK(joint.at(55, 55).value[0] == Approx(0.4));
    CHECK(joint.at(55, 55).stamp_ns == 40);
    CHECK(joint.at(55, 55).reason == Reason::ok);
    CHECK(joint.newest_ns() == 40);
}

TEST_CASE("a missing value has a reason") {
    CHECK(make_joint().at(0, 0).reason == Reason::waiting_for_position);
    Joint joint = ready_joint();
    CHECK(joint.at(9, 9).reason == Reason::history_too_short);
    CHECK(joint.at(56, 56).reason == Reason::position_stale);
    CHECK(joint.staleness().count() == 1);
    joint.push(62, Reason::ok, {0.6}, false);
    CHECK(joint.at(50, 50).reason == Reason::position_gap);
    CHECK(joint.gap().count() == 1);
    CHECK(joint.at(40, 40).reason == Reason::ok);
}

TEST_CASE("a bad reading invalidates only the adjacent sample times") {
    Joint joint = ready_joint();
    joint.push(52, Reason::encoder_fault, {0.5}, false);
    joint.push(62, Reason::ok, {0.6}, false);
    joint.push(72, Reason::ok, {0.7}, false);
    CHECK(joint.at(40, 40).reason == Reason::ok);
    for (const int instant : {41, 50, 59}) {
        CHECK(joint.at(instant, instant).reason == Reason::encoder_fault);
    }
    CHECK(joint.at(60, 60).reason == Reason::ok);
    CHECK(joint.at(65, 65).reason == Reason::ok);
}

TEST_CASE("a reading beyond the range is rejected") {
    Joint joint = ready_joint();
    joint.push(52, Reason::ok, {1.001}, false);
    CHECK(joint.at(50, 50).reason == Reason::position_out_of_range);
    CHECK(joint.range().count() == 1);
}

TEST_CASE("a joint must qualify at the start and after a silence or a fault") {
    Joint joint = make_joint();
    joint.push(12, Reason::ok, {0}, false);
    joint.push(22, Reason::ok, {0}, false);
    CHECK(joint.at(20, 20).reason == Reason::qualifying);
    joint.push(32, Reason::ok, {0}, false);
    CHECK(joint.at(30, 30).reason == Reason::ok);
    CHECK(joint.at(25, 25).reason == Reason::qualifying);
    joint.push(52, Reason::ok, {0}, false); // a silence of 20 ns
    CHECK(joint.at(50, 50).reason == Reason::qualifying);
    joint.push(62, Reason::ok, {0}, false);
    joint.push(72, Reason::ok, {0}, false);
    CHECK(joint.at(70, 70).reason == Reason::ok);
    joint.disqualify();
    joint.push(82, Reason::ok, {0}, false);
    CHECK(joint.at(80, 80).reason == Reason::qualifying);
}

TEST_CASE("a reading that is not later than the last is counted and ignored") {
    Joint joint = ready_joint();
    joint.push(42, Reason::ok, {0.4}, false);
    joint.push(32, Reason::encoder_fault, {0.9}, false);
    CHECK(joint.not_later() == 2);
    CHECK(joint.at(40, 40).value[0] == Approx(0.4));
}

TEST_CASE("two different readings with one stamp are both rejected") {
    Joint joint = ready_joint();
    joint.push(42, Reason::ok, {0.9}, false);
    CHECK(joint.at(40, 40).reason == Reason::time_not_increasing);
    CHECK(joint.at(30, 40).reason == Reason::ok);
}

namespace {

/// A value every 10 ns, at most 2 ns late.
Joint periodic_joint() {
    Joint joint({25, 0, {1, 1}, 10, 2}, {{{-1, 1}}}, position_reasons);
    joint.push(10, Reason::ok, {0.1}, false);
    joint.push(20, Reason::ok, {0.2}, false);
    return joint;
}

} // namespace

TEST_CASE("a value that was due and has not come is missing; the last one is not held") {
    Joint joint = periodic_joint();
    CHECK(joint.at(25, 33).reason == Reason::ok); // it may come until 33
    CHECK(joint.origin(25) == ValueOrigin::held);
    CHECK(joint.at(25, 34).reason == Reason::position_missing);
    CHECK(joint.at(34, 34).reason == Reason::position_missing);
    CHECK(joint.at(20, 34).reason == Reason::ok);
    CHECK(joint.pending(25, 34));
    CHECK_FALSE(joint.pending(25, 56)); // the next would be too far away
}

TEST_CASE("a missing value is interpolated when the next one comes, unless the gap is too long") {
    Joint joint = periodic_joint();
    joint.push(40, Reason::ok, {0.4}, false);
    CHECK_FALSE(joint.pending(25, 41));
    CHECK(joint.at(30, 41).value[0] == Approx(0.3));
    CHECK(joint.origin(30) == ValueOrigin::bridged);
    CHECK(joint.origin(15) == ValueOrigin::interpolated);
    CHECK(joint.origin(40) == ValueOrigin::measured);
    joint.push(66, Reason::ok, {0.6}, false);
    CHECK(joint.at(50, 67).reason == Reason::position_gap);
}

TEST_CASE("outputs have their own reasons") {
    Track<1, 4> output({15, 0, {1, 10}}, {{{-1, 1}}}, output_reasons);
    CHECK(output.at(0, 0).reason == Reason::waiting_for_output);
    output.push(0, Reason::ok, {5}, false);
    CHECK(output.at(0, 0).reason == Reason::output_out_of_range);
    output.push(10, Reason::ok, {0}, false);
    CHECK(output.at(26, 26).reason == Reason::output_stale);
    output.push(30, Reason::ok, {0}, false);
    CHECK(output.at(20, 20).reason == Reason::output_gap);
}

} // namespace track_test
