// SPDX-License-Identifier: Apache-2.0
#include "tests/vcan/lateness.hpp"

#include "tests/support/catch.hpp"
#include "tests/vcan/peer.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <thread>

namespace dfdyn::tests {
namespace {

using std::chrono::milliseconds;

/// Observes how late this machine wakes a sleeping thread, until it is destroyed.
class LatenessWatch {
  public:
    LatenessWatch() : thread_([this] { observe(); }) {}
    ~LatenessWatch() {
        stop_ = true;
        thread_.join();
    }
    LatenessWatch(const LatenessWatch&) = delete;
    LatenessWatch& operator=(const LatenessWatch&) = delete;

    /// Returns the largest lateness so far.
    [[nodiscard]] milliseconds longest() const { return longest_; }

  private:
    void observe() {
        using std::chrono::steady_clock;
        while (!stop_) {
            const auto due = steady_clock::now() + milliseconds(5);
            std::this_thread::sleep_until(due);
            const auto late = std::chrono::duration_cast<milliseconds>(steady_clock::now() - due);
            longest_ = std::max(longest_.load(), late);
        }
    }

    std::atomic<bool> stop_ = false;
    std::atomic<milliseconds> longest_{};
    std::thread thread_;
};

constexpr int most_stalls = 12; // half a minute of attempts

/// An attempt that throws is wrong: programs do not start in time on a machine that stalls.
bool succeeds(const std::function<bool()>& attempt) {
    try {
        return attempt();
    } catch (const std::exception& error) {
        WARN(error.what());
        return false;
    }
}

} // namespace

bool right_unless_stalled(const std::function<bool()>& attempt, milliseconds shortest_stall) {
    static int stalls = 0;
    while (true) {
        const LatenessWatch watch;
        if (succeeds(attempt)) {
            return true;
        }
        if (keeps_time() || watch.longest() < shortest_stall) {
            return false;
        }
        if (++stalls >= most_stalls) {
            WARN("not judged: this machine stalled during " << stalls << " attempts of all tests");
            return true;
        }
    }
}

} // namespace dfdyn::tests
