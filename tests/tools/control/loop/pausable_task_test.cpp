// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/pausable_task.hpp"

#include "tests/support/catch.hpp"
#include "tests/tools/control/pendulum.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

namespace pausable_task_test {

using namespace dfdyn::tools;
using namespace dfdyn::tests;

constexpr double period_s = 0.001;

std::unique_ptr<Task> sine() {
    TonesTask task{JointVector::Constant(1, 0.3), {{{0.5, 0.4, 0.2}}}, 1};
    return make_task(task, test_pendulum(), period_s, 1);
}

/// References of `ticks` ticks with a lead-in from `offset` at the start and a pause at tick `paused`.
std::vector<Reference> references(int ticks, double offset, int paused,
                                  const JointVector& speed_limit = JointVector()) {
    PausableTask task(sine(), period_s);
    std::vector<Reference> result;
    for (int tick = 0; tick < ticks; ++tick) {
        result.push_back(task.next());
        if (tick == 0 && offset != 0) {
            result.back().position[0] += offset;
            task.lead_in(JointVector::Constant(1, offset), speed_limit);
        }
        if (tick == paused) {
            task.pause();
        }
    }
    return result;
}

TEST_CASE("without a lead-in or a pause the references are those of the task") {
    const std::unique_ptr<Task> task = sine();
    for (const Reference& reference : references(3000, 0, -1)) {
        const Reference expected = task->next();
        CHECK(reference.position == expected.position);
        CHECK(reference.velocity == expected.velocity);
        CHECK(reference.acceleration == expected.acceleration);
    }
}

TEST_CASE("velocity and acceleration are the derivatives of a position that is led in and pauses") {
    const int paused = GENERATE(-1, 400, 2000); // never, during the lead-in of 1.5 s, after it
    CAPTURE(paused);
    const std::vector<Reference> all = references(2500, -0.2, paused);
    for (int i = 1; i + 1 < 2500; ++i) {
        CAPTURE(i);
        const Reference &before = all[static_cast<std::size_t>(i) - 1],
                        &here = all[static_cast<std::size_t>(i)],
                        &after = all[static_cast<std::size_t>(i) + 1];
        const double velocity = (after.position[0] - before.position[0]) / (2 * period_s);
        const double acceleration = (after.velocity[0] - before.velocity[0]) / (2 * period_s);
        const double lag = paused < 0 ? 5e-4 : 7e-3; // a pause lowers the rate by 1 % in each tick
        CHECK(here.velocity[0] == Approx(velocity).margin(lag));
        const bool corner =
            std::abs(i - paused) <= 2 || std::abs(i - paused - 101) <= 2; // of the pause's rate
        CHECK((corner || here.acceleration[0] == Approx(acceleration).margin(5e-2)));
    }
}

TEST_CASE("a pause during a lead-in stops the motion where it is") {
    const std::vector<Reference> all = references(2500, -0.2, 400);
    const Reference& last = all.back();
    CHECK(last.velocity[0] == 0);
    CHECK(last.acceleration[0] == 0);
    CHECK(last.position == all[510].position);
    CHECK(last.position[0] < all[0].position[0] + 0.19);
}

TEST_CASE("a lead-in goes straight to the start of the path within a quarter of the speed limit") {
    const double limit = GENERATE(0.2, 0.4, 10.0); // rad/s
    CAPTURE(limit);
    const std::vector<Reference> led = references(9000, -0.2, -1, JointVector::Constant(1, limit));
    const double most = std::min(PausableTask::lead_in_speed, PausableTask::lead_in_share * limit);
    const auto ticks = static_cast<std::size_t>(1.875 * 0.2 / most / period_s);
    const double start = led[0].position[0] + 0.2;
    for (std::size_t i = 1; i < ticks; ++i) {
        CHECK(led[i].velocity[0] <= most + 1e-9);
        CHECK(led[i].position[0] <= start + 1e-6);
    }
    const std::vector<Reference> path = references(9000, 0, -1);
    std::size_t later = ticks;
    while (led[later].position != path[10].position) {
        ++later;
        REQUIRE(later < ticks + 20);
    }
    for (std::size_t i = 10; i + later < 9000 + 10; ++i) {
        CHECK(led[i + later - 10].position == path[i].position);
    }
}

} // namespace pausable_task_test
