// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/core/snapshot_writer.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>

namespace snapshot_writer_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using Bytes = std::vector<std::byte>;

using UdFloat = TestModel<float, DerivativeFreeReduced<6, 3>, 15>;
using Parametric = TestParametric<float>;
using Mean = TestMean<float, DerivativeFreeReduced<6, 3>, 5>;
using Kernel = TestKernel<float, DerivativeFreeReduced<6, 3>, 5>;

/// Returns an estimator that has learned for 80 ticks, with a half-learned sample if `half`.
template <class Model>
struct Learned {
    typename Model::Constants constants;
    Estimator<Model> estimator;
    std::int64_t now = 0;

    explicit Learned(std::mt19937_64& engine, bool half = false)
        : constants(make_constants<Model>(engine, 0.999)), estimator(constants) {
        for (; now < 80; ++now) {
            estimator.tick(moving_sample<Model>(now, engine), Budget::unlimited());
        }
        if (half) {
            estimator.tick(moving_sample<Model>(now++, engine),
                           Budget{Estimator<Model>::cost().largest_step - 1});
        }
    }
};

/// Takes the whole snapshot in pieces of 0 to `largest_piece` bytes.
template <class Model>
Bytes in_pieces(Estimator<Model>& estimator, std::size_t largest_piece, std::mt19937_64& engine) {
    SnapshotWriter writer(estimator);
    Bytes bytes(writer.bytes());
    std::uniform_int_distribution<std::size_t> sizes(0, largest_piece);
    while (writer.result() == SnapshotResult::in_progress) {
        const std::size_t room = std::min(sizes(engine), bytes.size() - writer.written());
        const std::span piece = std::span(bytes).subspan(writer.written(), room);
        REQUIRE(writer.next(piece) == room);
    }
    REQUIRE(writer.result() == SnapshotResult::ok);
    REQUIRE(writer.written() == bytes.size());
    return bytes;
}

TEMPLATE_TEST_CASE("pieces of any size give the same snapshot as one call", "", UdFloat, Parametric, Mean,
                   Kernel) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const bool half_learned : {false, true}) {
        Learned<TestType> arm(engine, half_learned);
        const Bytes whole = snapshot_of(arm.estimator);
        for (const std::size_t piece : {1U, 2U, 7U, 64U, 1000U, 100'000U}) {
            CAPTURE(half_learned, piece);
            CHECK((in_pieces(arm.estimator, piece, engine) == whole));
        }
    }
}

TEST_CASE("each step writes at most the given number of bytes and nothing beyond the snapshot") {
    DFDYN_SEEDED_ENGINE(engine);
    Learned<UdFloat> arm(engine);
    const Bytes whole = snapshot_of(arm.estimator);
    Bytes buffer(whole.size() + 10, std::byte{0xAB});
    SnapshotWriter writer(arm.estimator);
    std::size_t before = 0;
    while (writer.step(buffer, 100) == SnapshotResult::in_progress) {
        REQUIRE(writer.written() == before + 100);
        before = writer.written();
    }
    CHECK(writer.result() == SnapshotResult::ok);
    CHECK(std::equal(whole.begin(), whole.end(), buffer.begin()));
    CHECK(std::count(buffer.end() - 10, buffer.end(), std::byte{0xAB}) == 10);

    SnapshotWriter too_large(arm.estimator);
    CHECK(too_large.step(std::span(buffer).first(whole.size() - 1), 100) == SnapshotResult::wrong_size);
    CHECK(arm.estimator.tick(moving_sample<UdFloat>(arm.now, engine), Budget::unlimited()).status.learned());
}

// The twin gets no output and no budget in the ticks of the snapshot.
TEMPLATE_TEST_CASE("ticks during a snapshot predict and do not learn, and learning continues afterwards", "",
                   UdFloat, Parametric, Mean, Kernel) {
    DFDYN_SEEDED_ENGINE(engine);
    for (const bool half_learned : {false, true}) {
        Learned<TestType> arm(engine, half_learned);
        Estimator<TestType> twin = arm.estimator;
        Bytes buffer(arm.estimator.snapshot_bytes());
        const Bytes before = snapshot_of(arm.estimator);
        SnapshotWriter writer(arm.estimator);
        int held = 0;
        const auto tick = [&](Budget budget, Reason reason) {
            auto sample = moving_sample<TestType>(arm.now++, engine);
            const auto estimate = arm.estimator.tick(sample, budget);
            REQUIRE(estimate.status.reason() == reason);
            sample.output_valid = reason == Reason::ok;
            const auto expected = twin.tick(sample, reason == Reason::ok ? budget : Budget::predict_only());
            REQUIRE(same(estimate.prediction, expected.prediction));
            REQUIRE(same(estimate.standard_deviation, expected.standard_deviation));
        };
        while (writer.step(buffer, 37) == SnapshotResult::in_progress) {
            if (writer.written() < buffer.size() - sizeof(SnapshotChecksum)) {
                tick(Budget::unlimited(), Reason::learning_held);
                CHECK(arm.estimator.advance(Budget::unlimited()) == !half_learned);
                ++held;
            }
        }
        CHECK((buffer == before));
        CHECK(arm.estimator.counters().reasons[static_cast<int>(Reason::learning_held)] ==
              static_cast<std::uint64_t>(held));
        for (int t = 0; t < 50; ++t) {
            tick(Budget::unlimited(), Reason::ok);
        }
        CHECK((snapshot_of(arm.estimator) == snapshot_of(twin)));
        CHECK((snapshot_of(arm.estimator) != before));
    }
}

TEST_CASE("a snapshot that exceeds its ticks is rejected and learning continues") {
    DFDYN_SEEDED_ENGINE(engine);
    Learned<UdFloat> arm(engine);
    Bytes buffer(arm.estimator.snapshot_bytes());
    constexpr std::uint32_t ticks = 5;
    SnapshotWriter writer(arm.estimator, ticks);
    for (std::uint32_t t = 0; t < 3 * ticks; ++t) {
        CAPTURE(t);
        CHECK(writer.step(buffer, 10) ==
              (t <= ticks ? SnapshotResult::in_progress : SnapshotResult::changed));
        const Status status =
            arm.estimator.tick(moving_sample<UdFloat>(arm.now++, engine), Budget::unlimited()).status;
        CHECK(status.reason() == (t < ticks ? Reason::learning_held : Reason::ok));
    }
    Estimator<UdFloat> other(arm.constants);
    CHECK(other.restore(buffer) != SnapshotResult::ok);
    // The next snapshot is a new attempt.
    CHECK((in_pieces(arm.estimator, 100, engine) == snapshot_of(arm.estimator)));
}

TEST_CASE("a snapshot is refused if the estimator was reset, restored or overwritten during the copy") {
    DFDYN_SEEDED_ENGINE(engine);
    Learned<UdFloat> arm(engine);
    const Bytes whole = snapshot_of(arm.estimator);
    const Estimator<UdFloat> other = arm.estimator;
    Bytes buffer(whole.size());
    const auto result_after = [&](auto change) {
        SnapshotWriter writer(arm.estimator);
        writer.step(buffer, whole.size() / 2);
        change();
        return writer.step(buffer, whole.size());
    };
    CHECK(result_after([] {}) == SnapshotResult::ok);
    CHECK(result_after([&] { arm.estimator.reset(); }) == SnapshotResult::changed);
    CHECK(result_after([&] { CHECK(arm.estimator.restore(whole) == SnapshotResult::ok); }) ==
          SnapshotResult::changed);
    CHECK(result_after([&] { arm.estimator = other; }) == SnapshotResult::changed);
    CHECK(result_after([&] { arm.estimator.restart_window(); }) == SnapshotResult::ok);
}

TEST_CASE("learning continues after an abandoned snapshot, and a second snapshot replaces the first") {
    DFDYN_SEEDED_ENGINE(engine);
    Learned<UdFloat> arm(engine);
    Bytes buffer(arm.estimator.snapshot_bytes());
    const auto reason_of_tick = [&] {
        return arm.estimator.tick(moving_sample<UdFloat>(arm.now++, engine), Budget::unlimited())
            .status.reason();
    };
    {
        SnapshotWriter abandoned(arm.estimator);
        abandoned.step(buffer, 50);
        CHECK(reason_of_tick() == Reason::learning_held);
    }
    CHECK(reason_of_tick() == Reason::ok);
    SnapshotWriter first(arm.estimator);
    first.step(buffer, 50);
    SnapshotWriter second(arm.estimator);
    CHECK(reason_of_tick() == Reason::learning_held);
    CHECK(second.step(buffer, buffer.size()) == SnapshotResult::ok);
    CHECK(reason_of_tick() == Reason::ok);
    CHECK(first.step(buffer, buffer.size()) == SnapshotResult::changed);
}

TEST_CASE("a snapshot in pieces does not use the heap") {
    DFDYN_SEEDED_ENGINE(engine);
    Learned<UdFloat> arm(engine);
    Bytes buffer(arm.estimator.snapshot_bytes());
    const AllocationGuard guard;
    SnapshotWriter writer(arm.estimator);
    while (writer.step(buffer, 100) == SnapshotResult::in_progress) {
    }
    const HeapCalls calls = guard.calls();
    CHECK(writer.result() == SnapshotResult::ok);
    CHECK(calls.allocations == 0);
}

} // namespace snapshot_writer_test
