// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/task/task.hpp"

#include "tests/support/catch.hpp"
#include "tools/base/text/error.hpp"
#include "tools/robot/urdf/read_robot.hpp"
#include "tools/simulation/scenario/scenario.hpp"
#include "tools/simulation/task/inverse_kinematics.hpp"

#include <cmath>

namespace task_test {

using namespace dfdyn::tools;

constexpr double period_s = 1e-3;

void check_derivatives(const TaskModel& model, const Robot& robot, int steps) {
    const std::unique_ptr<Task> task = make_task(model, robot, period_s, 3);
    Reference past = task->next();
    CHECK(past.velocity.norm() == 0);
    Reference here = task->next();
    for (int i = 0; i < steps; ++i) {
        const Reference next = task->next();
        const JointVector velocity = (next.position - past.position) / (2 * period_s);
        const JointVector acceleration = (next.velocity - past.velocity) / (2 * period_s);
        REQUIRE((velocity - here.velocity).norm() < 0.02);
        REQUIRE((acceleration - here.acceleration).norm() < 0.3);
        past = here;
        here = next;
    }
}

Robot icub() {
    ReadRobotOptions options;
    options.tip = "r_hand";
    return read_robot(DFDYN_TEST_DATA_DIR "/robots/icub_right_arm/icub_right_arm.urdf", options);
}

/// A circle that is well within reach.
CircleTask small_circle() {
    CircleTask circle;
    circle.rest_posture = (JointVector(4) << -0.6, 0.6, 0.3, 1.3).finished();
    circle.centre = InverseKinematics(icub()).tip(circle.rest_posture);
    circle.radius = 0.02;
    return circle;
}

TEST_CASE("a multisine starts at rest and stays within its amplitude and has correct derivatives") {
    MultisineTask model;
    model.centre = JointVector::Constant(3, 1);
    model.amplitude = JointVector::Constant(3, 0.6);
    const std::unique_ptr<Task> task = make_task(model, Robot(), period_s, 1);
    CHECK((task->next().position - model.centre).norm() == 0);
    double largest = 0;
    for (int i = 0; i < 20000; ++i) {
        largest = std::max(largest, (task->next().position - model.centre).cwiseAbs().maxCoeff());
    }
    CHECK(largest <= 0.6);
    CHECK(largest > 0.3);
    check_derivatives(model, Robot(), 4000);
}

TEST_CASE("point to point reaches each posture in turn at rest") {
    PointToPointTask model;
    for (const double q : {0.0, 1.0, -0.5}) {
        model.postures.push_back(JointVector::Constant(2, q));
    }
    const std::unique_ptr<Task> task = make_task(model, Robot(), period_s, 1);
    for (int i = 0; i < 6000; ++i) {
        const Reference reference = task->next();
        if (i % 1500 == 1200) { // moves of 1 s followed by 0.5 s at rest
            const double expected[] = {1.0, -0.5, 0.0, 1.0};
            CHECK(reference.position[0] == expected[i / 1500]);
            CHECK(reference.velocity.norm() == 0);
        }
    }
    check_derivatives(model, Robot(), 4000);
}

TEST_CASE("the reference of the circle follows the circle with correct derivatives") {
    const Robot robot = icub();
    InverseKinematics kinematics(robot);
    CircleTask circle = small_circle();
    const std::unique_ptr<Task> task = make_task(circle, robot, period_s, 1);
    double turned = 0;
    double past = 0;
    for (int i = 0; i < 12000; ++i) {
        const Eigen::Vector3d from_centre = kinematics.tip(task->next().position) - circle.centre;
        REQUIRE(std::abs(from_centre.z()) < 2e-4);
        REQUIRE(std::hypot(from_centre.x(), from_centre.y()) == Approx(circle.radius).margin(2e-4));
        const double angle = std::atan2(from_centre.y(), from_centre.x());
        turned += std::remainder(angle - past, 2 * std::acos(-1));
        past = angle;
    }
    // In 12 s, the start of 2 s counts half.
    CHECK(turned / (2 * std::acos(-1)) == Approx(11).margin(0.01));
    circle.posture_variation = 0.05;
    circle.speed_variation = 0.1;
    circle.centre_variation = 0.002;
    check_derivatives(circle, robot, 6000);
}

TEST_CASE("the circle varies from turn to turn by about the configured amount") {
    const Robot robot = icub();
    InverseKinematics kinematics(robot);
    CircleTask circle = small_circle();
    circle.centre_variation = 0.003;
    circle.variation_time_s = 0.5;
    const std::unique_ptr<Task> task = make_task(circle, robot, period_s, 1);
    double squares = 0;
    constexpr int samples = 60000;
    for (int i = 0; i < samples; ++i) {
        const double height = kinematics.tip(task->next().position).z() - circle.centre.z();
        squares += height * height / samples;
    }
    CHECK(std::sqrt(squares) == Approx(0.003).epsilon(0.4));
}

TEST_CASE("a circle out of reach is reported with the place and the distance and the limiting joint") {
    const Robot robot = icub();
    CircleTask circle = small_circle();
    circle.centre.x() -= 0.5;
    CHECK_THROWS_WITH(
        make_task(circle, robot, period_s, 1),
        Catch::Matchers::StartsWith(
            "task.circle: at 0 degrees: expected a point within reach of the tip, found one ") &&
            Catch::Matchers::ContainsSubstring(" mm out of reach (") &&
            Catch::Matchers::ContainsSubstring("r_elbow at its lower limit 0.2618 rad"));
    circle = small_circle();
    circle.radius = 1;
    CHECK_THROWS_AS(make_task(circle, robot, period_s, 1), InputError);
}

} // namespace task_test
