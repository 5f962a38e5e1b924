// SPDX-License-Identifier: Apache-2.0
// Snapshots during ticks: a timer signal interrupts the copy at any instruction, as an interrupt does on a
// microcontroller, or a thread ticks on another core. A replay of the same ticks then gives every state that
// the estimator had; an accepted snapshot must be one of them.
#include "dfdyn/core/snapshot_writer.hpp"

#include "tests/firmware_lib/support/test_model.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <map>
#include <sys/time.h>
#include <thread>

namespace snapshot_interrupt_test {

using namespace dfdyn;
using namespace dfdyn::tests;
using Bytes = std::vector<std::byte>;
using Model = TestModel<float, DerivativeFreeReduced<6, 3>, 24>;

// A slow or busy machine uses up the ticks sooner, so requirements are relative to the number of attempts.
constexpr std::size_t attempts = 1500;
constexpr std::size_t most_ticks = 10'000;
constexpr std::size_t least_attempts = 50;

/// An estimator that is ticked by another context, with all data for a replay.
class Ticked {
  public:
    explicit Ticked(std::mt19937_64& engine)
        : constants_(make_constants<Model>(engine, 0.999)), estimator_(constants_), held_(most_ticks) {
        std::uniform_int_distribution<std::int64_t> operations(0, 2 * Estimator<Model>::cost().learn);
        for (std::size_t t = 0; t < most_ticks; ++t) {
            samples_.push_back(moving_sample<Model>(static_cast<std::int64_t>(t), engine));
            budgets_.push_back({t % 3 == 0 ? operations(engine) : 2 * Estimator<Model>::cost().learn});
        }
    }

    /// Performs the next tick, in any context; returns false if there are no more.
    bool tick() noexcept {
        const std::size_t now = ticks_.load(std::memory_order_relaxed);
        if (now == most_ticks) {
            return false;
        }
        const Status status = estimator_.tick(samples_[now], budgets_[now]).status;
        held_[now] = status.reason() == Reason::learning_held ? 1 : 0;
        ticks_.store(now + 1, std::memory_order_release);
        return true;
    }

    /// Waits for the next tick; returns false if there is none.
    [[nodiscard]] bool wait() const noexcept {
        const std::size_t before = ticks_;
        while (ticks_ == before && before < most_ticks) {
        }
        return ticks_ < most_ticks;
    }
    [[nodiscard]] Estimator<Model>& estimator() noexcept { return estimator_; }
    [[nodiscard]] std::size_t held_ticks() const {
        return static_cast<std::size_t>(std::count(held_.begin(), held_.end(), 1));
    }

    /// Counts the snapshots that equal the state after some tick and, when restored, predict like the
    /// estimator at that time.
    [[nodiscard]] std::size_t true_ones(std::map<Bytes, int> snapshots) const {
        std::size_t found = 0;
        Estimator<Model> replayed(constants_);
        Estimator<Model> restored(constants_);
        for (std::size_t t = 0; t < ticks_; ++t) {
            // With a budget of zero U-D does nothing, as during a hold.
            replayed.tick(samples_[t], held_[t] != 0 ? Budget::predict_only() : budgets_[t]);
            const auto snapshot = snapshots.find(snapshot_of(replayed));
            if (snapshot != snapshots.end()) {
                REQUIRE(restored.restore(snapshot->first) == SnapshotResult::ok);
                REQUIRE(predict_alike(restored, replayed, t));
                found += static_cast<std::size_t>(snapshot->second);
                snapshots.erase(snapshot);
            }
        }
        return found;
    }

  private:
    [[nodiscard]] bool predict_alike(Estimator<Model>& restored, Estimator<Model> now, std::size_t t) const {
        now.restart_window();
        bool alike = true;
        for (int i = 0; i < 10; ++i, t = (t + 1) % most_ticks) {
            Model::Sample sample = samples_[t];
            sample.output_valid = false;
            sample.time_ns = period_ns * i;
            alike = alike && same(restored.tick(sample, Budget::predict_only()),
                                  now.tick(sample, Budget::predict_only()));
        }
        return alike;
    }

    Model::Constants constants_;
    Estimator<Model> estimator_;
    std::vector<Model::Sample> samples_;
    std::vector<Budget> budgets_;
    std::vector<char> held_;
    std::atomic<std::size_t> ticks_ = 0;
};

/// Results of many attempts.
struct Attempts {
    std::map<Bytes, int> accepted; ///< with the number of occurrences
    std::size_t accepted_count = 0;
    std::size_t refused = 0;

    [[nodiscard]] std::size_t made() const noexcept { return accepted_count + refused; }

    void add(const Bytes& bytes, SnapshotResult result) {
        REQUIRE((result == SnapshotResult::ok || result == SnapshotResult::changed));
        if (result == SnapshotResult::ok) {
            ++accepted[bytes];
            ++accepted_count;
        } else {
            ++refused;
        }
    }
};

/// Takes many snapshots in pieces of random sizes, some with a wait for a tick between two pieces. A tick may
/// learn before each snapshot. `max_held_ticks(attempt)`: maximum ticks of that snapshot.
template <class MaxHeldTicks>
Attempts write_many(Ticked& ticked, std::mt19937_64& engine, const MaxHeldTicks& max_held_ticks) {
    Attempts result;
    Bytes buffer(ticked.estimator().snapshot_bytes());
    std::uniform_int_distribution<std::size_t> sizes(1, 2000);
    for (std::size_t attempt = 0; attempt < attempts && ticked.wait(); ++attempt) {
        SnapshotWriter writer(ticked.estimator(), max_held_ticks(attempt));
        while (writer.step(buffer, sizes(engine)) == SnapshotResult::in_progress) {
            if (engine() % 4 == 0) {
                static_cast<void>(ticked.wait());
            }
        }
        result.add(buffer, writer.result());
    }
    return result;
}

constexpr auto no_limit = [](std::size_t /*attempt*/) { return std::uint32_t{most_ticks}; };

Ticked* interrupted = nullptr; // by the timer

/// While it exists, ticks `ticked` by a signal every 40 us, or as fast as the system allows.
class Timer {
  public:
    explicit Timer(Ticked& ticked) {
        interrupted = &ticked;
        struct sigaction action {};
        action.sa_handler = [](int) { interrupted->tick(); };
        action.sa_flags = SA_RESTART;
        sigaction(SIGALRM, &action, &before_);
        set_period_us(40);
    }
    Timer(const Timer&) = delete;
    Timer& operator=(const Timer&) = delete;
    ~Timer() {
        set_period_us(0);
        sigaction(SIGALRM, &before_, nullptr);
    }

  private:
    static void set_period_us(long period) {
        const itimerval interval{{0, period}, {0, period}};
        setitimer(ITIMER_REAL, &interval, nullptr);
    }

    struct sigaction before_ {};
};

TEST_CASE("a snapshot in pieces that a timer's ticks interrupt is always consistent") {
    DFDYN_SEEDED_ENGINE(engine);
    Ticked ticked(engine);
    Attempts result;
    {
        const Timer timer(ticked);
        result = write_many(ticked, engine, no_limit);
    }
    CHECK(result.made() > least_attempts);
    CHECK(result.refused == 0);
    CHECK(ticked.held_ticks() > result.made() / 2);
    CHECK(result.accepted.size() > result.made() / 2);
    CHECK(ticked.true_ones(result.accepted) == result.accepted_count);
}

TEST_CASE("among snapshots that exceed their ticks, every accepted one is consistent") {
    DFDYN_SEEDED_ENGINE(engine);
    Ticked ticked(engine);
    Attempts result;
    {
        const Timer timer(ticked);
        const auto one_or_more = [](std::size_t attempt) { return attempt % 2 == 0 ? 1 : no_limit(attempt); };
        result = write_many(ticked, engine, one_or_more);
    }
    CHECK(result.made() > least_attempts);
    CHECK(result.refused > result.made() / 50);
    CHECK(result.accepted.size() > result.made() / 4);
    CHECK(ticked.true_ones(result.accepted) == result.accepted_count);
}

TEST_CASE("a snapshot in one call that a learning tick interrupts is rejected") {
    DFDYN_SEEDED_ENGINE(engine);
    Ticked ticked(engine);
    Attempts result;
    {
        const Timer timer(ticked);
        Bytes buffer(ticked.estimator().snapshot_bytes());
        for (std::size_t attempt = 0; attempt < attempts; ++attempt) {
            const SnapshotResult taken = ticked.estimator().snapshot(buffer);
            result.add(buffer, taken);
        }
    }
    CHECK(result.refused > 0);
    CHECK(ticked.true_ones(result.accepted) == result.accepted_count);
}

TEST_CASE("a snapshot in pieces during ticks of another thread is always consistent") {
    DFDYN_SEEDED_ENGINE(engine);
    Ticked ticked(engine);
    std::atomic<bool> done = false;
    std::thread thread([&] {
        while (!done && ticked.tick()) {
            std::this_thread::sleep_for(std::chrono::microseconds(10));
        }
    });
    const Attempts result = write_many(ticked, engine, no_limit);
    done = true;
    thread.join();
    CHECK(result.made() > least_attempts);
    CHECK(result.refused == 0);
    CHECK(result.accepted.size() > result.made() / 4);
    CHECK(ticked.held_ticks() > result.made() / 4);
    CHECK(ticked.true_ones(result.accepted) == result.accepted_count);
}

} // namespace snapshot_interrupt_test
