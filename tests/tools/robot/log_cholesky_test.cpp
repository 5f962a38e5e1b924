// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/identification/log_cholesky.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"
#include "tests/tools/robot/arms.hpp"

#include <Eigen/Eigenvalues>

namespace tools = dfdyn::tools;

namespace {

tools::LogCholesky random_coordinates(std::mt19937_64& engine) {
    std::normal_distribution<double> normal;
    return tools::LogCholesky::NullaryExpr([&] { return normal(engine); });
}

double smallest_eigenvalue(const tools::InertialParameters& parameters) {
    return tools::pseudo_inertia(parameters).selfadjointView<Eigen::Lower>().eigenvalues()[0];
}

} // namespace

TEST_CASE("coordinates and parameters of a body convert into each other") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int i = 0; i < 20; ++i) {
        const tools::InertialParameters body = dfdyn::tests::random_body(engine).parameters();
        CHECK((tools::parameters_from(tools::coordinates_of(body)) - body).norm() < 1e-12 * body.norm());
        const tools::LogCholesky coordinates = random_coordinates(engine);
        const tools::LogCholesky back = tools::coordinates_of(tools::parameters_from(coordinates));
        CHECK((back - coordinates).norm() < 1e-6 * coordinates.norm());
    }
}

TEST_CASE("any coordinates give a physically possible body") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int i = 0; i < 100; ++i) {
        const tools::InertialParameters body = tools::parameters_from(random_coordinates(engine));
        CHECK(body[0] > 0);
        CHECK(smallest_eigenvalue(body) > 0);
        CHECK_FALSE(tools::inertia_fault(body));
    }
}

TEST_CASE("the derivative of the parameters equals finite differences") {
    DFDYN_SEEDED_ENGINE(engine);
    const tools::LogCholesky at = random_coordinates(engine);
    const Eigen::Matrix<double, 10, 10> slope = tools::parameters_slope(at);
    for (int j = 0; j < 10; ++j) {
        const tools::LogCholesky step = 1e-6 * tools::LogCholesky::Unit(j);
        const tools::InertialParameters difference =
            (tools::parameters_from(at + step) - tools::parameters_from(at - step)) / 2e-6;
        // The tolerance covers the rounding errors of the differences.
        CHECK((slope.col(j) - difference).norm() < 1e-8 * tools::parameters_from(at).norm());
    }
}

TEST_CASE("impossible bodies are replaced by close possible ones and others are kept") {
    DFDYN_SEEDED_ENGINE(engine);
    const tools::InertialParameters body = dfdyn::tests::random_body(engine).parameters();
    CHECK(tools::made_consistent(body, 0.1) == body);
    tools::InertialParameters negative = body;
    negative[0] = -1;
    const Eigen::Matrix3d beyond_triangle = Eigen::Vector3d(0.01, 0.01, 0.05).asDiagonal();
    const tools::InertialParameters flat = tools::body_parameters(2, {0.1, 0, 0.2}, beyond_triangle);
    for (const tools::InertialParameters& bad :
         {negative, flat, tools::InertialParameters(tools::InertialParameters::Zero())}) {
        CHECK_FALSE(tools::is_consistent(bad));
        const tools::InertialParameters mended = tools::made_consistent(bad, 0.1);
        CHECK(tools::is_consistent(mended));
        CHECK(smallest_eigenvalue(mended) > 0);
    }
    const tools::InertialParameters mended = tools::made_consistent(flat, 0.1);
    CHECK((mended - flat).head<4>().norm() < 1e-12); // mass and centre are kept
}
