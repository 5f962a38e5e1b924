// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/stop_signal.hpp"

#include <csignal>

namespace dfdyn::tools {
namespace {

std::atomic<bool> stop = false; // a signal handler reaches nothing else
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

extern "C" void set_stop(int /*signal*/) { stop = true; }

} // namespace

const std::atomic<bool>& stop_on_signals() {
    struct sigaction action {};
    action.sa_handler = set_stop; // without SA_RESTART: the signal is to end the sleep
    for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
        ::sigaction(signal_number, &action, nullptr);
    }
    return stop;
}

} // namespace dfdyn::tools
