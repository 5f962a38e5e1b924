// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/estimator.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

namespace estimator_snapshot_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using Bytes = std::vector<std::byte>;

using UdFloat = TestModel<float, DerivativeFreeReduced<6, 3>, 5>;
using UdDouble = TestModel<double, DerivativeFreeReduced<6, 3>, 5>;
using Parametric = TestParametric<float>;
using Mean = TestMean<float, DerivativeFreeReduced<6, 3>, 5>;
using Kernel = TestKernel<float, DerivativeFreeReduced<6, 3>, 5>;
using KernelDouble = TestKernel<double, DerivativeFreeReduced<6, 3>, 5>;

/// An estimator that has learned; `tiny` leaves a sample half learned.
template <class Model>
void give_past(Estimator<Model>& estimator, std::mt19937_64& engine, bool tiny) {
    for (int t = 0; t < 80; ++t) {
        estimator.tick(moving_sample<Model>(t, engine), Budget::unlimited());
    }
    if (tiny) {
        estimator.tick(moving_sample<Model>(80, engine), Budget{Estimator<Model>::cost().largest_step - 1});
    }
}

/// Writes the correct checksum of changed bytes.
void seal(Bytes& bytes) {
    const std::span checked = std::span(bytes).first(bytes.size() - sizeof(SnapshotChecksum));
    const SnapshotChecksum crc = crc32(checked);
    std::memcpy(bytes.data() + checked.size(), &crc, sizeof crc);
}

/// Restores changed bytes into an estimator that has learned other data; a rejection must change nothing.
template <class Model>
SnapshotResult restored(Estimator<Model>& other, const Bytes& bytes) {
    const Bytes before = snapshot_of(other);
    const SnapshotResult result = other.restore(bytes);
    if (result != SnapshotResult::ok && snapshot_of(other) != before) {
        FAIL("a rejected snapshot changed the state");
    }
    return result;
}

/// A model's constants, an estimator with a snapshot, and another estimator of the same model.
template <class Model>
struct Pair {
    typename Model::Constants constants;
    Estimator<Model> original;
    Estimator<Model> other;

    explicit Pair(std::mt19937_64& engine, bool tiny = false)
        : constants(make_constants<Model>(engine, 0.999)), original(constants), other(constants) {
        give_past(original, engine, tiny);
        for (int t = 0; t < 20; ++t) {
            other.tick(moving_sample<Model>(5000 + t, engine), Budget::unlimited());
        }
    }
};

TEMPLATE_TEST_CASE("a restored estimator behaves like the original once its window is full", "", UdFloat,
                   UdDouble, Parametric, Mean, Kernel, KernelDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const bool half_learned : {false, true}) {
        CAPTURE(half_learned);
        Pair<TestType> pair(engine, half_learned);
        REQUIRE(pair.original.regression().sample_pending() == half_learned);
        REQUIRE(restored(pair.other, snapshot_of(pair.original)) == SnapshotResult::ok);
        CHECK((snapshot_of(pair.other) == snapshot_of(pair.original)));
        int compared = 0;
        for (int t = 81; t < 200; ++t) {
            auto sample = moving_sample<TestType>(t, engine);
            sample.output_valid = t > 90; // neither learns while the restored one cannot
            const auto expected = pair.original.tick(sample, Budget{t < 100 ? 100 : 3000});
            const auto estimate = pair.other.tick(sample, Budget{t < 100 ? 100 : 3000});
            if (estimate.status.predicted()) {
                REQUIRE(same(estimate, expected));
                ++compared;
            }
        }
        CHECK(compared == 200 - 81 - 6);
        CHECK((snapshot_of(pair.other) == snapshot_of(pair.original)));
    }
}

TEMPLATE_TEST_CASE("every changed byte and every truncation of a snapshot is rejected and changes nothing",
                   "", UdFloat, UdDouble, Parametric, Mean, Kernel, KernelDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    Pair<TestType> pair(engine, true);
    const Bytes bytes = snapshot_of(pair.original);
    std::size_t rejected = 0;
    for (std::size_t place = 0; place < bytes.size(); ++place) {
        Bytes damaged = bytes;
        damaged[place] ^= static_cast<std::byte>(1 + engine() % 255);
        rejected += restored(pair.other, damaged) != SnapshotResult::ok ? 1 : 0;
        const Bytes truncated(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(place));
        rejected += restored(pair.other, truncated) == SnapshotResult::wrong_size ? 1 : 0;
    }
    CHECK(rejected == 2 * bytes.size());
}

TEMPLATE_TEST_CASE("NaN in a snapshot is rejected despite a correct checksum", "", UdFloat, UdDouble,
                   Parametric, Mean, Kernel, KernelDouble) {
    DFDYN_SEEDED_ENGINE(engine);
    Pair<TestType> pair(engine, true);
    const Bytes bytes = snapshot_of(pair.original);
    // All bits set: NaN in either precision, and no valid index or size.
    constexpr std::size_t width = sizeof(typename TestType::Scalar);
    std::size_t wrongly_restored = 0;
    const std::size_t end = bytes.size() - sizeof(SnapshotChecksum);
    for (std::size_t place = sizeof(SnapshotHeader); place + width <= end; place += sizeof(float)) {
        Bytes forged = bytes;
        std::fill_n(forged.begin() + static_cast<std::ptrdiff_t>(place), width, std::byte{0xFF});
        seal(forged);
        wrongly_restored += restored(pair.other, forged) == SnapshotResult::corrupted ? 0 : 1;
    }
    CHECK(wrongly_restored == 0);
}

// The memory layout of U depends on the machine, but a snapshot does not.
TEST_CASE("the snapshot of U-D begins with U above its diagonal, by columns") {
    DFDYN_SEEDED_ENGINE(engine);
    const Pair<UdFloat> pair(engine);
    const Bytes bytes = snapshot_of(pair.original);
    const auto& factor = pair.original.regression().learner().factor();
    std::size_t place = sizeof(SnapshotHeader);
    for (int j = 0; j < UdFloat::columns; ++j) {
        for (int i = 0; i < j; ++i) {
            CAPTURE(i, j);
            float number = 0;
            std::memcpy(&number, bytes.data() + place, sizeof number);
            CHECK(number == factor.upper(i, j));
            place += sizeof number;
        }
    }
}

// The snapshot begins with U, followed by the variances.
TEST_CASE("variances that are not positive are rejected despite a correct checksum") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto with_number = [&]<class Model>(Pair<Model>& pair, std::size_t index, float number) {
        Bytes forged = snapshot_of(pair.original);
        std::memcpy(forged.data() + sizeof(SnapshotHeader) + index * sizeof number, &number, sizeof number);
        seal(forged);
        return restored(pair.other, forged);
    };
    constexpr std::size_t columns = UdFloat::columns;
    constexpr std::size_t first_variance = columns * (columns - 1) / 2;
    Pair<UdFloat> ud(engine);
    for (const float number : {0.0F, -0.0F, -1.0F}) {
        for (std::size_t j = 0; j < columns; ++j) {
            CAPTURE(number, j);
            CHECK(with_number(ud, first_variance + j, number) == SnapshotResult::corrupted);
        }
    }
    CHECK(with_number(ud, first_variance, 2.0F) == SnapshotResult::ok);
}

// A snapshot can only be checked for a correct checksum and finite numbers; an overflow is detected in use.
TEST_CASE("with extreme numbers from a snapshot nothing is predicted until a reset") {
    DFDYN_SEEDED_ENGINE(engine);
    Pair<UdFloat> pair(engine);
    Bytes forged = snapshot_of(pair.original);
    for (std::size_t element = 0; element < 48; ++element) { // of U
        constexpr float absurd = 3e38F;
        std::memcpy(forged.data() + sizeof(SnapshotHeader) + element * sizeof absurd, &absurd, sizeof absurd);
    }
    seal(forged);
    REQUIRE(pair.other.restore(forged) == SnapshotResult::ok);
    for (int t = 0; t < 10; ++t) {
        const auto estimate = pair.other.tick(moving_sample<UdFloat>(t, engine), Budget::unlimited());
        CHECK((t < 6 || estimate.status.prediction == Reason::state_not_finite));
        CHECK(estimate.prediction[0] == 0);
        CHECK(std::isinf(estimate.standard_deviation[1]));
    }
    pair.other.reset();
    for (int t = 0; t < 10; ++t) {
        const auto estimate = pair.other.tick(moving_sample<UdFloat>(t, engine), Budget::unlimited());
        CHECK((t < 6 || estimate.status.learned()));
    }
}

TEST_CASE("a snapshot of another model is rejected") {
    DFDYN_SEEDED_ENGINE(engine);
    Pair<UdFloat> pair(engine);
    const Bytes bytes = snapshot_of(pair.original);
    const auto result_in = [&]<class Model>(Model, std::uint32_t identity) {
        auto constants = make_constants<Model>(engine);
        constants.identity = identity;
        Estimator<Model> estimator(constants);
        return estimator.restore(bytes);
    };
    constexpr std::uint32_t identity = 0x1234;
    CHECK(result_in(UdFloat{}, identity) == SnapshotResult::ok);
    CHECK(result_in(UdFloat{}, identity + 1) == SnapshotResult::wrong_model);
    CHECK(result_in(UdDouble{}, identity) == SnapshotResult::wrong_model);
    CHECK(result_in(TestModel<float, DerivativeFreeReduced<6, 3>, 6>{}, identity) ==
          SnapshotResult::wrong_model);
    CHECK(result_in(TestModel<float, DerivativeFreeReduced<7, 3>, 5>{}, identity) ==
          SnapshotResult::wrong_model);
}

TEST_CASE("bytes that are not a snapshot and other versions are rejected") {
    DFDYN_SEEDED_ENGINE(engine);
    Pair<UdFloat> pair(engine);
    Bytes bytes = snapshot_of(pair.original);
    ++*reinterpret_cast<unsigned char*>(bytes.data() + offsetof(SnapshotHeader, version));
    CHECK(restored(pair.other, bytes) == SnapshotResult::wrong_version);
    for (int trial = 0; trial < 1000; ++trial) {
        Bytes foreign(engine() % 2000);
        std::generate(foreign.begin(), foreign.end(), [&] { return static_cast<std::byte>(engine()); });
        REQUIRE(restored(pair.other, foreign) != SnapshotResult::ok);
    }
}

TEST_CASE("restoring restarts the window and keeps the counters") {
    DFDYN_SEEDED_ENGINE(engine);
    Pair<UdFloat> pair(engine);
    const auto ticks = pair.other.counters().ticks;
    REQUIRE(pair.other.restore(snapshot_of(pair.original)) == SnapshotResult::ok);
    CHECK(pair.other.counters().ticks == ticks);
    CHECK(pair.other.tick(moving_sample<UdFloat>(1, engine), Budget::unlimited()).status.prediction ==
          Reason::window_filling);
    CHECK(pair.original.snapshot_bytes() <= Estimator<UdFloat>::snapshot_capacity);
    std::vector<std::byte> small(pair.original.snapshot_bytes() - 1);
    CHECK(pair.original.snapshot(small) == SnapshotResult::wrong_size);
}

} // namespace estimator_snapshot_test
