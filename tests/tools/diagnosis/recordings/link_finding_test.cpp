// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/link_finding.hpp"

#include "tests/support/catch.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"

namespace link_finding_test {

using namespace dfdyn::tools;

const Eigen::Vector3d centre(0.1, -0.2, 0.05);
const Eigen::Matrix3d inertia = Eigen::Vector3d(0.02, 0.03, 0.04).asDiagonal();
const InertialParameters described = body_parameters(2, centre, inertia);

/// Finding for a link whose parameters are known to 1 % of a body of 1 kg and 0.1 m.
Finding found(const InertialParameters& real) {
    InertialParameters deviation;
    deviation << 1e-2, Eigen::Vector3d::Constant(1e-3), Eigen::Matrix<double, 6, 1>::Constant(1e-4);
    const InertialCovariance covariance = deviation.cwiseAbs2().asDiagonal();
    return link_finding(described, real - described, covariance);
}

TEST_CASE("a link with other moments of inertia is named by them, about its centre of mass") {
    Eigen::Matrix3d real = inertia;
    real(1, 1) += 0.02;
    real(0, 2) = real(2, 0) = 0.004;
    const Finding finding = found(body_parameters(2, centre, real));
    CHECK(finding.effect == effects::link_rotational_inertia_error().name);
    REQUIRE(finding.parameters.size() == 6);
    const std::array<double, 6> expected{0, 0.02, 0, 0, 0.004, 0}; // xx yy zz xy xz yz
    for (std::size_t k = 0; k < 6; ++k) {
        const FoundParameter& one = finding.parameters[k];
        CHECK(one.value == Approx(expected[k]).margin(1e-12));
        CHECK(one.low < one.value);
        CHECK(one.value < one.high);
    }
    CHECK(finding.parameters[1].name == "delta_iyy");
    CHECK(finding.parameters[4].name == "delta_ixz");
}

TEST_CASE(
    "a link with its mass or its centre elsewhere is named by these, though its inertia about the joint "
    "changes, too") {
    const Finding moved = found(body_parameters(2, centre + Eigen::Vector3d(0.1, 0, 0), inertia));
    CHECK(moved.effect == effects::link_inertia_error().name);
    REQUIRE(moved.parameters.size() == 4);
    CHECK(moved.parameters[0].value == Approx(0).margin(1e-12));
    CHECK(moved.parameters[1].value == Approx(0.1));

    const Finding heavier = found(body_parameters(3, centre, inertia));
    CHECK(heavier.effect == effects::link_inertia_error().name);
    CHECK(heavier.parameters[0].value == Approx(1));
    CHECK(heavier.parameters[1].value == Approx(0).margin(1e-12));
}

} // namespace link_finding_test
