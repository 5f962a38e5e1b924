// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/inertia.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <random>
#include <vector>

namespace tools = dfdyn::tools;

namespace {

struct Point {
    double mass;
    Eigen::Vector3d at;
};

std::vector<Point> random_points(std::mt19937_64& engine, int count) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    std::vector<Point> points;
    for (int i = 0; i < count; ++i) {
        points.push_back({1 + 0.5 * uniform(engine), {uniform(engine), uniform(engine), uniform(engine)}});
    }
    return points;
}

/// Mass, first moment and inertia by definition, as sums over points.
tools::InertialParameters summed(const std::vector<Point>& points) {
    tools::InertialParameters sum = tools::InertialParameters::Zero();
    for (const auto& [m, x] : points) {
        tools::InertialParameters one;
        one << m, m * x, m * (x.y() * x.y() + x.z() * x.z()), -m * x.x() * x.y(), -m * x.x() * x.z(),
            m * (x.x() * x.x() + x.z() * x.z()), -m * x.y() * x.z(), m * (x.x() * x.x() + x.y() * x.y());
        sum += one;
    }
    return sum;
}

Eigen::Isometry3d some_placement() {
    return Eigen::Translation3d(0.3, -0.2, 0.5) *
           Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, -2, 0.5).normalized());
}

} // namespace

TEST_CASE("a displaced body has the parameters of its displaced points") {
    DFDYN_SEEDED_ENGINE(engine);
    std::vector<Point> points = random_points(engine, 6);
    const tools::InertialParameters before = summed(points);
    for (Point& point : points) {
        point.at = some_placement() * point.at;
    }
    CHECK((tools::moved(before, some_placement()) - summed(points)).norm() < 1e-12);
}

TEST_CASE("the pseudo-inertia is the second moment of the points and converts back") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::vector<Point> points = random_points(engine, 5);
    Eigen::Matrix4d moments = Eigen::Matrix4d::Zero();
    for (const auto& [m, x] : points) {
        moments += m * x.homogeneous() * x.homogeneous().transpose();
    }
    const tools::InertialParameters parameters = summed(points);
    CHECK((tools::pseudo_inertia(parameters) - moments).norm() < 1e-12);
    CHECK((tools::parameters_of(moments) - parameters).norm() < 1e-12);
}

TEST_CASE("the parameters of a body follow from mass and centre and inertia about the centre") {
    const Eigen::Vector3d centre(0.1, -0.2, 0.3);
    const Eigen::Matrix3d inertia = Eigen::Vector3d(0.02, 0.03, 0.04).asDiagonal();
    const tools::InertialParameters parameters = tools::body_parameters(2, centre, inertia);
    CHECK((parameters.segment<3>(1) - 2 * centre).norm() < 1e-15);
    CHECK(parameters[4] == Approx(0.02 + 2 * (0.04 + 0.09)));
    CHECK(parameters[5] == Approx(2 * 0.1 * 0.2)); // the product of inertia is minus the integral of xy
    CHECK(parameters[9] == Approx(0.04 + 2 * (0.01 + 0.04)));
}

TEST_CASE("a body is taken apart into mass and centre and inertia about the centre as it was made of them") {
    const Eigen::Vector3d centre(0.1, -0.2, 0.3);
    Eigen::Matrix3d inertia;
    inertia << 0.02, 0.001, -0.002, 0.001, 0.03, 0.003, -0.002, 0.003, 0.04;
    const tools::InertialParameters parameters = tools::body_parameters(2, centre, inertia);
    const tools::CentralBody body = tools::central_body(parameters);
    CHECK(body.mass == 2);
    CHECK((body.centre - centre).norm() < 1e-15);
    CHECK((body.inertia - inertia).norm() < 1e-15);
    tools::CentralInertia expected;
    expected << 0.02, 0.03, 0.04, 0.001, -0.002, 0.003;
    CHECK((tools::central_inertia(parameters) - expected).norm() < 1e-15);
}

TEST_CASE("physically impossible parameters are detected in any frame") {
    const auto fault = [](double mass, double xx, double yy, double zz) {
        const Eigen::Matrix3d inertia = Eigen::Vector3d(xx, yy, zz).asDiagonal();
        return tools::inertia_fault(
            tools::moved(tools::body_parameters(mass, {0.1, 0.2, 0.3}, inertia), some_placement()));
    };
    CHECK_FALSE(fault(1, 0.01, 0.02, 0.025));
    CHECK_FALSE(fault(1, 0.01, 0.02, 0.03)); // a flat body
    CHECK_FALSE(fault(1, 0, 0, 0));          // a point mass
    CHECK_FALSE(tools::inertia_fault(tools::InertialParameters::Zero()));
    CHECK_THAT(fault(-1, 0.01, 0.02, 0.025).value_or(""), Catch::Matchers::ContainsSubstring("mass -1 kg"));
    CHECK_THAT(fault(0, 0.01, 0.02, 0.025).value_or(""), Catch::Matchers::ContainsSubstring("mass 0 kg"));
    CHECK_THAT(fault(1, 0.01, 0.02, 0.04).value_or(""),
               Catch::Matchers::ContainsSubstring("larger than the sum of the other two"));
    CHECK_THAT(fault(1, -0.01, 0.02, 0.02).value_or(""), Catch::Matchers::ContainsSubstring("not positive"));
}
