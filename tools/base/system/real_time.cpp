// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/real_time.hpp"

#include <cerrno>
#include <system_error>

#include <ctime>
#include <sched.h>
#include <sys/mman.h>

namespace dfdyn::tools {

std::string become_real_time() {
    std::string refused;
    const auto ask = [&](const char* what, int result) {
        if (result != 0) {
            refused += (refused.empty() ? "" : "; ") + std::string(what) + ": " +
                       std::system_category().message(errno);
        }
    };
    sched_param priority{};
    // the priority of the kernel's interrupt threads, which must not be exceeded
    priority.sched_priority = 50;
    ask("real-time priority", ::sched_setscheduler(0, SCHED_FIFO, &priority));
    ask("memory locked", ::mlockall(MCL_CURRENT | MCL_FUTURE));
    return refused;
}

void sleep_until(std::int64_t due_ns) {
    const timespec due{due_ns / 1'000'000'000, due_ns % 1'000'000'000};
    ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);
}

} // namespace dfdyn::tools
