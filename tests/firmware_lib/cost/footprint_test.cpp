// SPDX-License-Identifier: Apache-2.0
// Maps and learners use the bytes that they declare, plus pointers and indices whose number does not depend
// on the sizes.
#include "dfdyn/dfdyn.hpp"

#include "tests/support/catch.hpp"

#include <type_traits>

namespace {

using namespace dfdyn;

/// Including alignment.
constexpr std::int64_t most_beside_arrays = 5 * storage_alignment;

template <class Part>
void check_bytes(std::int64_t state_bytes) {
    const auto bytes = static_cast<std::int64_t>(sizeof(Part));
    CAPTURE(bytes, state_bytes);
    CHECK(bytes >= state_bytes);
    CHECK(bytes <= state_bytes + most_beside_arrays);
}

template <class Input, int joints>
void check_input() {
    const auto check = [](auto number) {
        using Map = typename Input::template Map<decltype(number), joints>;
        check_bytes<Map>(Map::state_bytes(joints, Input::lags, Input::features_per_joint));
    };
    check(float{});
    check(double{});
}

template <template <class, int, int> class Form, int columns, int outputs>
void check_learner() {
    const auto check = [](auto number) {
        using Learner = Form<decltype(number), columns, outputs>;
        check_bytes<Learner>(Learner::state_bytes(columns, outputs));
    };
    check(float{});
    check(double{});
}

} // namespace

TEST_CASE("numbers stored in place take the bytes of `storage_bytes`") {
    CHECK(sizeof(Storage<float, 1>) == storage_bytes<float>(1));
    CHECK(sizeof(Storage<float, 8>) == storage_bytes<float>(8));
    CHECK(sizeof(Storage<float, 9>) == storage_bytes<float>(9));
    CHECK(sizeof(Storage<double, 101>) == storage_bytes<double>(101));
}

TEMPLATE_TEST_CASE("an input map takes the bytes that it declares", "", DerivativeFree<3>, DerivativeFree<40>,
                   DerivativeFreeWeighted<10>, (DerivativeFreeReduced<10, 3>), (DerivativeFreeReduced<60, 5>),
                   DerivativeFreeStructured<30>, Standard<6>, Standard<40>, StandardMeasured) {
    check_input<TestType, 1>();
    check_input<TestType, 4>();
    check_input<TestType, 30>();
}

TEMPLATE_TEST_CASE_SIG("a learner takes the bytes that it declares", "",
                       ((int columns, int outputs), columns, outputs), (1, 1), (4, 2), (7, 6), (50, 6),
                       (100, 1), (201, 6), (1000, 6)) {
    check_learner<UdCovariance, columns, outputs>();
}

TEMPLATE_TEST_CASE_SIG("the learner of SPK takes the bytes that it declares", "",
                       ((int columns, int parameters, int outputs), columns, parameters, outputs), (4, 1, 1),
                       (50, 13, 6), (500, 52, 6)) {
    using Learner = BlockArrow<float, columns, parameters, outputs>;
    const auto bytes = static_cast<std::int64_t>(sizeof(Learner));
    const std::int64_t state_bytes = Learner::state_bytes(columns, parameters, outputs);
    CHECK(bytes >= state_bytes);
    CHECK(bytes <= state_bytes + 2 * most_beside_arrays); // contains a learner
}

TEST_CASE("a physics map takes the bytes that it declares") {
    using Arm = Chain<6>;
    using Columns = Physics<DerivativeFreeReduced<20, 3>, 40, ViscousFriction<6>>;
    using Map = Columns::Map<float, Arm>;
    check_bytes<Map>(Map::state_bytes({}));
}

// An estimator contains its parts, its columns, its outputs and its counters.
TEST_CASE("a firmware model takes the bytes of its parts") {
    using Arm = Joints<6, 6>;
    using Whole = Estimator<Model<float, Arm, DerivativeFreeReduced<10, 3>, RandomFourier<100>>>;
    const std::int64_t parts = DerivativeFreeReduced<10, 3>::Map<float, 6>::state_bytes(6, 10, 3) +
                               UdCovariance<float, 200, 6>::state_bytes(200, 6) + storage_bytes<float>(18) +
                               storage_bytes<float>(200) + 3 * storage_bytes<float>(6) +
                               std::int64_t{sizeof(Counters)} + std::int64_t{sizeof(InnovationGate<float>)};
    CHECK(Whole::footprint().state_bytes >= parts);
    CHECK(Whole::footprint().state_bytes <= parts + 320);
}
