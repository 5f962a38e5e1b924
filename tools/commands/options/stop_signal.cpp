// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/stop_signal.hpp"

#include <csignal>
#include <initializer_list>

namespace dfdyn::tools {
namespace {

std::atomic<bool> stop = false, toggle = false; // a signal handler can access static objects only
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

extern "C" void set_stop(int /*signal*/) { stop = true; }
extern "C" void turn_over(int /*signal*/) { toggle = !toggle; }

void handle(std::initializer_list<int> signals, void (*handler)(int)) {
    struct sigaction action {};
    action.sa_handler = handler; // without SA_RESTART, so that the signal ends the sleep
    for (const int signal_number : signals) {
        ::sigaction(signal_number, &action, nullptr);
    }
}

} // namespace

const std::atomic<bool>& stop_on_signals() {
    handle({SIGINT, SIGTERM, SIGHUP}, set_stop);
    return stop;
}

const std::atomic<bool>& toggle_on_signal() {
    handle({SIGUSR1}, turn_over);
    return toggle;
}

} // namespace dfdyn::tools
