// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/dfdyn.hpp"

#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random_robot.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace physics_map_test {

using namespace dfdyn;
using namespace dfdyn::tests;

constexpr int joints = 3;
constexpr int all_columns = 10 * joints + 14;

using Arm = Chain<joints>;
using HostArm = Chain<dynamic>;

/// Some effects on joints of the arm.
template <class Motion, int p>
using FirmwarePhysics = Physics<Motion, p, ViscousFriction<3>, CoulombFriction<2>, StribeckFriction<1>,
                                RotorInertia<2>, JointSpring<1>, TorqueRipple<2>, OutputOffset<3>>;
/// Every effect, with a number of joints known at run time.
template <class Motion>
using HostPhysics =
    Physics<Motion, dynamic, ViscousFriction<dynamic>, CoulombFriction<dynamic>, StribeckFriction<dynamic>,
            RotorInertia<dynamic>, JointSpring<dynamic>, TorqueRipple<dynamic>, OutputOffset<dynamic>>;

template <class T, int count>
void assign(Storage<T, count>& storage, const std::vector<double>& values) {
    storage = Storage<T, count>::zeros(extent<count>(static_cast<int>(values.size())));
    std::transform(values.begin(), values.end(), storage.begin(),
                   [](double value) { return static_cast<T>(value); });
}

template <template <int> class Effect, int count, class Effects>
auto& constants_of(Effects& effects) {
    return static_cast<typename Effect<count>::template Constants<float>&>(effects);
}

template <class Scalar>
Placement<Scalar> cast(const Placement<double>& placement) {
    Placement<Scalar> result{};
    std::copy_n(placement.rotation, 9, result.rotation);
    std::copy_n(placement.translation, 3, result.translation);
    return result;
}

/// Sets chain, selection, scales and gains, for fixed and run-time sizes.
template <class Constants>
void set_common(Constants& constants, const tools::Robot& robot, const std::vector<double>& selected) {
    constants.chain.joint = decltype(constants.chain.joint)::zeros({});
    if constexpr (std::is_same_v<decltype(constants.selected), Storage<std::int32_t, dynamic>>) {
        constants.chain.joint = decltype(constants.chain.joint)::zeros({joints});
    }
    for (int i = 0; i < joints; ++i) {
        const tools::RobotJoint& joint = robot.joints[static_cast<std::size_t>(i)];
        constants.chain.joint[i].placement = cast<float>(placement_of(joint.placement));
        std::copy_n(joint.axis.data(), 3, constants.chain.joint[i].axis);
        constants.chain.joint[i].prismatic = joint.prismatic;
    }
    std::copy_n(robot.gravity.data(), 3, constants.chain.gravity);
    assign(constants.motion.scale, std::vector<double>(3 * joints, 1));
    assign(constants.motion_limit, std::vector<double>(3 * joints, 1000));
    assign(constants.selected, selected);
    std::vector<double> scale(selected.size());
    std::iota(scale.begin(), scale.end(), 2);
    assign(constants.column_scale, scale);
    assign(constants.output_gain, {1, 0.5, 4});
}

template <class Motion, int p>
auto firmware_constants(const tools::Robot& robot, const std::vector<double>& selected) {
    typename FirmwarePhysics<Motion, p>::template Constants<float, Arm> constants{};
    set_common(constants, robot, selected);
    constants.effects = {{{{0, 1, 2}}},
                         {{{0, 2}}, {{0.1F, 0.2F}}},
                         {{{1}}, {{0.1F}}, {{0.5F}}},
                         {{{0, 2}}},
                         {{{1}}},
                         {{{2, 2}}, {{4, 4}}, {{0, 1.5F}}},
                         {{{0, 1, 2}}}};
    return constants;
}

template <class Motion>
auto host_constants(const tools::Robot& robot, const std::vector<double>& selected) {
    typename HostPhysics<Motion>::template Constants<float, HostArm> constants{};
    set_common(constants, robot, selected);
    auto& effects = constants.effects;
    assign(constants_of<ViscousFriction, dynamic>(effects).row, {0, 1, 2});
    assign(constants_of<CoulombFriction, dynamic>(effects).row, {0, 2});
    assign(constants_of<CoulombFriction, dynamic>(effects).sign_velocity, {0.1, 0.2});
    assign(constants_of<StribeckFriction, dynamic>(effects).row, {1});
    assign(constants_of<StribeckFriction, dynamic>(effects).sign_velocity, {0.1});
    assign(constants_of<StribeckFriction, dynamic>(effects).stribeck_velocity, {0.5});
    assign(constants_of<RotorInertia, dynamic>(effects).row, {0, 2});
    assign(constants_of<JointSpring, dynamic>(effects).row, {1});
    assign(constants_of<TorqueRipple, dynamic>(effects).row, {2, 2});
    assign(constants_of<TorqueRipple, dynamic>(effects).cycles_per_rev, {4, 4});
    assign(constants_of<TorqueRipple, dynamic>(effects).phase, {0, 1.5});
    assign(constants_of<OutputOffset, dynamic>(effects).row, {0, 1, 2});
    return constants;
}

SampleWithDerivatives<float, joints, joints> random_sample(std::mt19937_64& engine) {
    SampleWithDerivatives<float, joints, joints> sample{};
    for (auto* values : {&sample.position, &sample.velocity, &sample.acceleration}) {
        for (float& value : *values) {
            value = static_cast<float>(uniform(engine, -3, 3));
        }
    }
    return sample;
}

std::vector<double> range(int count) {
    std::vector<double> indices(static_cast<std::size_t>(count));
    std::iota(indices.begin(), indices.end(), 0);
    return indices;
}

const std::vector<double> some_columns{1, 2, 6, 9, 13, 21, 24, 29, 30, 32, 34, 35, 36, 38, 41};

/// Computes ψ of a sample with a new map.
template <class PhysicsType, class AnyArm, class Constants, class Sizes, class Sample>
std::vector<float> psi_of(const Constants& constants, const Sizes& sizes, const Sample& sample) {
    typename PhysicsType::template Map<float, AnyArm> map(constants, sizes);
    map.push(sample);
    std::vector<float> psi(static_cast<std::size_t>(sizes.output_count * sizes.column_count));
    REQUIRE(map.evaluate(psi.data()));
    return psi;
}

using Measured = FirmwarePhysics<StandardMeasured, 15>;

TEST_CASE("selected columns equal those of the full matrix, scaled, in units of the outputs") {
    DFDYN_SEEDED_ENGINE(engine);
    const tools::Robot robot = random_robot(engine, joints);
    using All = FirmwarePhysics<StandardMeasured, all_columns>;
    const auto all_constants = firmware_constants<StandardMeasured, all_columns>(robot, range(all_columns));
    const auto constants = firmware_constants<StandardMeasured, 15>(robot, some_columns);
    for (int trial = 0; trial < 100; ++trial) {
        const auto sample = random_sample(engine);
        const auto all = psi_of<All, Arm>(all_constants, All::Sizes<Arm>{}, sample);
        const auto psi = psi_of<Measured, Arm>(constants, Measured::Sizes<Arm>{}, sample);
        for (std::size_t k = 0; k < joints; ++k) {
            for (std::size_t c = 0; c < some_columns.size(); ++c) {
                const auto column = static_cast<std::size_t>(some_columns[c]);
                const float expected = all[k * all_columns + column] * (static_cast<float>(c) + 2) /
                                       (static_cast<float>(column) + 2);
                CHECK(psi[k * some_columns.size() + c] == Approx(expected).epsilon(1e-6));
            }
        }
    }
}

TEST_CASE("the columns are those of the rigid body, then those of the effects in order") {
    DFDYN_SEEDED_ENGINE(engine);
    const tools::Robot robot = random_robot(engine, joints);
    using All = FirmwarePhysics<StandardMeasured, all_columns>;
    auto constants = firmware_constants<StandardMeasured, all_columns>(robot, range(all_columns));
    std::fill(constants.column_scale.begin(), constants.column_scale.end(), 1.0F);
    std::fill(constants.output_gain.begin(), constants.output_gain.end(), 1.0F);
    std::vector<float> xi(3 * joints);
    std::generate(xi.begin(), xi.end(), [&] { return static_cast<float>(uniform(engine, -3, 3)); });
    float psi[joints][all_columns];
    float rigid[joints][10 * joints];
    All::evaluate_rows(constants, All::Sizes<Arm>{}, xi.data(), psi[0]);
    rigid_body_regressor<Arm>(constants.chain, {}, xi.data(), rigid[0], 10 * joints);
    const int rows[] = {0, 1, 2, 0, 2, 1, 0, 2, 1, 2, 2, 0, 1, 2};
    const float entries[] = {xi[1],
                             xi[4],
                             xi[7],
                             std::tanh(xi[1] / 0.1F),
                             std::tanh(xi[7] / 0.2F),
                             std::tanh(xi[4] / 0.1F) * std::exp(-xi[4] * xi[4] / 0.25F),
                             xi[2],
                             xi[8],
                             xi[3],
                             std::sin(4 * xi[6]),
                             std::sin(4 * xi[6] + 1.5F),
                             1,
                             1,
                             1};
    for (int k = 0; k < joints; ++k) {
        for (int c = 0; c < all_columns; ++c) {
            CAPTURE(k, c);
            const int effect = c - 10 * joints;
            const float expected = effect < 0 ? rigid[k][c] : (rows[effect] == k ? entries[effect] : 0.0F);
            CHECK(psi[k][c] == Approx(expected).epsilon(1e-5).margin(1e-5));
        }
    }
}

TEST_CASE("a map with run-time sizes gives the firmware's columns") {
    DFDYN_SEEDED_ENGINE(engine);
    using Host = HostPhysics<StandardMeasured>;
    for (int trial = 0; trial < 100; ++trial) {
        const tools::Robot robot = random_robot(engine, joints);
        const auto sample = random_sample(engine);
        const auto psi = psi_of<Measured, Arm>(firmware_constants<StandardMeasured, 15>(robot, some_columns),
                                               Measured::Sizes<Arm>{}, sample);
        const Host::Sizes<HostArm> sizes{{joints}, {joints}, {joints}, {}, {15}};
        const auto host =
            psi_of<Host, HostArm>(host_constants<StandardMeasured>(robot, some_columns), sizes, sample);
        CHECK(psi == host);
    }
}

TEST_CASE("with run-time sizes an effect may have no columns") {
    DFDYN_SEEDED_ENGINE(engine);
    using Host = HostPhysics<StandardMeasured>;
    Host::Constants<float, HostArm> constants{};
    set_common(constants, random_robot(engine, joints), {3, 29, 30});
    assign(constants_of<JointSpring, dynamic>(constants.effects).row, {2});
    const auto sample = random_sample(engine);
    const auto psi =
        psi_of<Host, HostArm>(constants, Host::Sizes<HostArm>{{joints}, {joints}, {joints}, {}, {3}}, sample);
    CHECK(psi[2] == 0);
    CHECK(psi[5] == 0);
    CHECK(psi[8] == Approx(sample.position[2] * 4 * 4)); // column scale and gain
}

TEST_CASE("a row that is not finite is reported as invalid") {
    DFDYN_SEEDED_ENGINE(engine);
    tools::Robot robot = random_robot(engine, joints);
    robot.joints[1].prismatic = false;
    const auto constants = firmware_constants<StandardMeasured, 15>(robot, some_columns);
    Measured::Map<float, Arm> map(constants, {});
    float psi[joints * 15];
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            1001.0F, -1001.0F}) { // beyond the limit
        auto sample = random_sample(engine);
        sample.velocity[1] = bad;
        map.push(sample);
        CHECK_FALSE(map.evaluate(psi));
    }
    map.push(random_sample(engine));
    CHECK(map.evaluate(psi));
}

TEST_CASE("the motion may be estimated from positions alone") {
    DFDYN_SEEDED_ENGINE(engine);
    using Motion = DerivativeFreeStructured<4>;
    using Structured = FirmwarePhysics<Motion, 15>;
    auto constants = firmware_constants<Motion, 15>(random_robot(engine, joints), some_columns);
    std::vector<float> rows(15);
    structured_rows(StructuredFilters<float>{1000, 1e6F, 0.1F, 0.1F}, 4, rows.data());
    to_difference_form(rows.data(), 3, 4, constants.motion.rows.data());
    Structured::Map<float, Arm> map(constants, {});
    Motion::Map<float, joints> motion(constants.motion, {}, {}, {});
    for (int turn = 0; turn < 2; ++turn) {
        for (int t = 0; t < 5; ++t) {
            CHECK_FALSE(map.ready());
            Sample<float, joints, joints> sample{};
            std::generate(sample.position.begin(), sample.position.end(),
                          [&] { return 1e-5F * static_cast<float>(uniform(engine, -1, 1)); });
            map.push(sample);
            motion.push(sample);
        }
        REQUIRE(map.ready());
        float xi[3 * joints];
        float psi[joints * 15];
        float expected[joints * 15];
        motion.evaluate(xi);
        Structured::evaluate_rows(constants, {}, xi, expected);
        CHECK(map.evaluate(psi));
        CHECK(std::equal(std::begin(psi), std::end(psi), std::begin(expected)));
        map.restart();
        motion.restart();
    }
}

TEST_CASE("no call of a map uses the heap") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto constants =
        firmware_constants<StandardMeasured, 15>(random_robot(engine, joints), some_columns);
    const auto sample = random_sample(engine);
    float psi[joints * 15];
    const AllocationGuard guard;
    Measured::Map<float, Arm> map(constants, {});
    map.push(sample);
    bool right = map.ready() && map.evaluate(psi);
    map.restart();
    right = right && !map.ready();
    const HeapCalls calls = guard.calls();
    CHECK(right);
    CHECK(calls.allocations == 0);
}

TEST_CASE("the cost of a map is known at compile time and grows with the square of the joints") {
    constexpr auto cost = [](auto arm) { return Measured::Map<float, decltype(arm)>::cost({}); };
    static_assert(cost(Chain<3>{}) > rigid_body_cost<Chain<3>, float>({}));
    static_assert(cost(Chain<6>{}) < 5000);
    static_assert(cost(Chain<48>{}) < 5 * cost(Chain<24>{}));
    // Constants in flash: no constructor runs.
    static_assert(std::is_aggregate_v<Measured::Constants<float, Arm>>);
    static_assert(std::is_trivially_copyable_v<Measured::Constants<float, Arm>>);
    CHECK(sizeof(Measured::Map<float, Arm>) < 256);
}

} // namespace physics_map_test
