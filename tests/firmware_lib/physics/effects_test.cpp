// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/physics/effects.hpp"

#include "dfdyn/input/standard.hpp"
#include "dfdyn/physics/physics.hpp"
#include "tests/support/catch.hpp"

#include <Eigen/Core>
#include <unsupported/Eigen/AutoDiff>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace effects_test {

using namespace dfdyn;

/// (q, q̇, q̈) of two joints.
constexpr double xi[] = {0.3, -0.7, 2.5, -1.1, 0.2, -4};

/// A user-defined effect; no other code refers to it.
struct CubicDamping {
    static constexpr int identity = 1000;
    static constexpr int columns = 1;
    template <class>
    static constexpr std::int64_t column_cost = 2;
    static constexpr bool at_joint = true;

    template <class Scalar>
    struct Constants {
        Storage<std::int32_t, 1> row;
    };

    template <class Real, class Scalar>
    static Scalar value(const Constants<Real>& constants, int column, const Scalar* motion) noexcept {
        const Scalar& velocity = motion[3 * constants.row[column] + 1];
        return velocity * velocity * velocity;
    }
};

TEST_CASE("each effect evaluates its formula") {
    CHECK(ViscousFriction<1>::value(ViscousFriction<1>::Constants<double>{{{0}}}, 0, xi) == -0.7);
    CHECK(RotorInertia<2>::value(RotorInertia<2>::Constants<double>{{{0, 1}}}, 1, xi) == -4);
    CHECK(JointSpring<1>::value(JointSpring<1>::Constants<double>{{{1}}}, 0, xi) == -1.1);
    CHECK(OutputOffset<1>::value(OutputOffset<1>::Constants<double>{{{1}}}, 0, xi) == 1);
    CHECK(CoulombFriction<1>::value(CoulombFriction<1>::Constants<double>{{{0}}, {{0.1}}}, 0, xi) ==
          Approx(std::tanh(-7)).epsilon(1e-14));
    const StribeckFriction<2>::Constants<double> stribeck{{{0, 1}}, {{0.1, 0.05}}, {{0.5, 0.4}}};
    CHECK(StribeckFriction<2>::value(stribeck, 1, xi) ==
          Approx(std::tanh(4) * std::exp(-0.25)).epsilon(1e-14));
    CHECK(StribeckFriction<2>::value(stribeck, 0, xi) ==
          Approx(std::tanh(-7) * std::exp(-1.96)).epsilon(1e-14));
    const TorqueRipple<2>::Constants<double> ripple{{{1, 0}}, {{7, 3}}, {{0.5, 0}}};
    CHECK(TorqueRipple<2>::value(ripple, 0, xi) == Approx(std::sin(0.5 - 7 * 1.1)).epsilon(1e-14));
    CHECK(TorqueRipple<2>::value(ripple, 1, xi) == Approx(std::sin(0.9)).epsilon(1e-14));
}

TEST_CASE("in single precision a ripple of 200 cycles per turn keeps its phase") {
    const TorqueRipple<1>::Constants<float> single{{{0}}, {{200}}, {{0.3F}}};
    const TorqueRipple<1>::Constants<double> exact{{{0}}, {{200}}, {{static_cast<double>(0.3F)}}};
    for (float q = -3.1F; q < 3.1F; q += 0.0137F) {
        const float motion[] = {q, 0, 0};
        const double same[] = {static_cast<double>(q), 0, 0};
        CHECK(static_cast<double>(TorqueRipple<1>::value(single, 0, motion)) ==
              Approx(TorqueRipple<1>::value(exact, 0, same)).margin(1e-4));
    }
}

TEST_CASE(
    "at three times the sign velocity the smooth sign deviates from the sign by at most half a percent") {
    const CoulombFriction<1>::Constants<double> coulomb{{{0}}, {{0.01}}};
    for (const double sign : {-1.0, 1.0}) {
        const double motion[] = {0, sign * 0.03, 0};
        CHECK(CoulombFriction<1>::value(coulomb, 0, motion) == Approx(sign).margin(0.005));
    }
}

TEST_CASE("effect columns follow the body columns and each is in the row on which it acts") {
    using Arm = Chain<2>;
    using Effects = Physics<StandardMeasured, 6, ViscousFriction<2>, CubicDamping, OutputOffset<1>,
                            JointSpring<2>>; // 20 columns of bodies, then 2 + 1 + 1 + 2
    Effects::Constants<double, Arm> constants{};
    constants.effects = {{{{1, 0}}}, {{{1}}}, {{{0}}}, {{{0, 1}}}};
    std::iota(constants.selected.begin(), constants.selected.end(), 20);
    constants.column_scale = {{1, 1, 1, 1, 1, 2}};
    constants.output_gain = {{1, 10}};
    double psi[2][6];
    Effects::evaluate_rows(constants, {}, xi, psi[0]);
    const double expected[2][6] = {{0, -0.7, 0, 1, 0.3, 0}, {2, 0, 0.08, 0, 0, -22}};
    for (int k = 0; k < 2; ++k) {
        for (int c = 0; c < 6; ++c) {
            CAPTURE(k, c);
            CHECK(psi[k][c] == Approx(expected[k][c]));
        }
    }
}

TEST_CASE("a scalar with derivatives gives the derivatives of the effects") {
    using Arm = Chain<2>;
    using Effects = Physics<StandardMeasured, 14, ViscousFriction<2>, CoulombFriction<2>, StribeckFriction<2>,
                            RotorInertia<2>, JointSpring<2>, TorqueRipple<2>, OutputOffset<2>>;
    Effects::Constants<double, Arm> constants{};
    constants.effects = {{{{0, 1}}},
                         {{{0, 1}}, {{0.5, 0.8}}},
                         {{{0, 1}}, {{0.5, 0.8}}, {{0.6, 0.9}}},
                         {{{0, 1}}},
                         {{{0, 1}}},
                         {{{0, 1}}, {{2, 5}}, {{0, 1}}},
                         {{{0, 1}}}};
    std::iota(constants.selected.begin(), constants.selected.end(), 20);
    std::iota(constants.column_scale.begin(), constants.column_scale.end(), 1);
    constants.output_gain = {{2, 3}};
    using Dual = Eigen::AutoDiffScalar<Eigen::Matrix<double, 6, 1>>;
    Dual dual[6];
    for (int i = 0; i < 6; ++i) {
        dual[i] = Dual(xi[i], 6, i);
    }
    Dual psi[28];
    Effects::evaluate_rows(constants, {}, dual, psi);
    for (int i = 0; i < 6; ++i) {
        double motion[6];
        double ahead[28];
        double behind[28];
        std::copy_n(xi, 6, motion);
        motion[i] = xi[i] + 1e-5;
        Effects::evaluate_rows(constants, {}, motion, ahead);
        motion[i] = xi[i] - 1e-5;
        Effects::evaluate_rows(constants, {}, motion, behind);
        for (int entry = 0; entry < 28; ++entry) {
            CAPTURE(i, entry);
            CHECK(psi[entry].derivatives()[i] ==
                  Approx((ahead[entry] - behind[entry]) / 2e-5).epsilon(1e-7).margin(1e-7));
        }
    }
}

TEST_CASE("a sensor bias is an offset of an output") {
    using Arm = Chain<1, WrenchAtSensor<1>>;
    using Bias = Physics<StandardMeasured, 2, OutputOffset<6>>;
    Bias::Constants<double, Arm> constants{};
    constants.chain.output.link = 1;
    constants.effects = {{{{0, 1, 2, 3, 4, 5}}}};
    constants.selected = {{12, 15}}; // fz and mz
    constants.column_scale = {{1, 1}};
    constants.output_gain = {{1, 1, 1, 1, 1, 1}};
    double psi[6][2];
    Bias::evaluate_rows(constants, {}, xi, psi[0]);
    for (int k = 0; k < 6; ++k) {
        CHECK(psi[k][0] == (k == 2 ? 1 : 0));
        CHECK(psi[k][1] == (k == 5 ? 1 : 0));
    }
}

} // namespace effects_test
