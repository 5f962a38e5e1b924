// SPDX-License-Identifier: Apache-2.0
// dfdyn_linux_loop [SECONDS] runs the controller in a 1 kHz loop as on a real-time Linux: absolute times,
// locked memory, and SCHED_FIFO if permitted. Without SECONDS it runs as fast as possible, as in the tests;
// the arm is simulated in both cases. Prints the tracking error of each second.
#include "closed_loop.hpp"

#include <sched.h>
#include <sys/mman.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace {

constexpr int ticks_per_second = 1000;
constexpr int seconds_without_clock = 12;

ClosedLoop loop; // static, because it is large and nothing is allocated

void become_real_time() {
    constexpr sched_param priority{80};
    if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0 || sched_setscheduler(0, SCHED_FIFO, &priority) != 0) {
        std::puts("note: not allowed to lock memory or to run in real time");
    }
}

constexpr std::int64_t second_ns = 1'000'000'000;

std::int64_t nanoseconds(const timespec& time) { return time.tv_sec * second_ns + time.tv_nsec; }

/// Sleeps until the next period. Returns false if the loop is a period late or more. Missed ticks are
/// skipped: catching up in a burst would move the reference faster than the arm.
bool sleep_for_period(timespec& due) {
    due.tv_nsec += JointController::period_ns;
    due.tv_sec += due.tv_nsec / second_ns;
    due.tv_nsec %= second_ns;
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
        // interrupted by a signal: continue to sleep
    }
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    const bool in_time = nanoseconds(now) - nanoseconds(due) < JointController::period_ns;
    due = in_time ? due : now;
    return in_time;
}

} // namespace

int main(int count, char** arguments) {
    if (!loop.controller().valid()) { // every effort would be 0
        std::puts("the controller's gains are out of range");
        return 1;
    }
    const bool timed = count > 1;
    const long seconds = timed ? std::strtol(arguments[1], nullptr, 10) : seconds_without_clock;
    if (timed) {
        become_real_time();
    }
    timespec due{};
    clock_gettime(CLOCK_MONOTONIC, &due);
    float first = 0;
    float last = 0;
    long overruns = 0;
    for (long second = 0; second < seconds; ++second) {
        for (int i = 0; i < ticks_per_second; ++i) {
            overruns += timed && !sleep_for_period(due) ? 1 : 0;
            loop.tick();
        }
        last = loop.take_error(ticks_per_second);
        first = second == 0 ? last : first;
        std::printf("second %ld: tracking error %.3f mrad, learned share of joint 2 %.2f\n", second + 1,
                    1e3 * static_cast<double>(last),
                    static_cast<double>(loop.controller().forward().share()[1]));
    }
    std::printf("%ld ticks began a period late or more\n", overruns);
    const bool learned = last < first / 2 && loop.controller().forward().share()[1] > 0.5F;
    return learned || seconds < seconds_without_clock ? 0 : 1;
}
