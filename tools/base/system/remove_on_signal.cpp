// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/remove_on_signal.hpp"

#include "tools/base/text/text.hpp"

#include <array>
#include <atomic>
#include <climits>
#include <csignal>
#include <unistd.h>

namespace dfdyn::tools {
namespace {

enum class State : unsigned char { vacant, claimed, armed };

struct Slot {
    std::atomic<State> state = State::vacant;
    std::array<char, PATH_MAX> path{};
};
static_assert(std::atomic<State>::is_always_lock_free, "the signal handler reads it");

// Static storage, because a signal handler may neither allocate nor lock.
std::array<Slot, 16> slots;

extern "C" void remove_files_and_end(int signal_number) {
    for (const Slot& slot : slots) {
        if (slot.state.load() == State::armed) {
            ::unlink(slot.path.data());
        }
    }
    // SA_RESETHAND has restored the default action; delivered when this handler returns
    std::raise(signal_number);
}

void handle_unless_taken(int signal_number) {
    struct sigaction action {};
    if (::sigaction(signal_number, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) {
        return;
    }
    action.sa_handler = remove_files_and_end;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigfillset(&action.sa_mask);
    ::sigaction(signal_number, &action, nullptr);
}

std::size_t claim_slot(const std::string& path) {
    for (std::size_t index = 0; index < slots.size(); ++index) {
        State vacant = State::vacant;
        if (slots.at(index).state.compare_exchange_strong(vacant, State::claimed)) {
            return index;
        }
    }
    throw InputError(shown(path) + ": cannot create: " + std::to_string(slots.size()) +
                     " files are being written already");
}

} // namespace

RemoveOnSignal::RemoveOnSignal(const std::string& path) : slot_(claim_slot(path)) {
    Slot& slot = slots.at(slot_);
    if (path.size() >= slot.path.size()) {
        return;
    }
    slot.path.at(path.copy(slot.path.data(), path.size())) = '\0';
    slot.state = State::armed;
    for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
        handle_unless_taken(signal_number);
    }
}

RemoveOnSignal::~RemoveOnSignal() { slots.at(slot_).state = State::vacant; }

} // namespace dfdyn::tools
