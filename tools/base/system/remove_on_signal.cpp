// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/remove_on_signal.hpp"

#include <array>
#include <atomic>
#include <climits>
#include <csignal>
#include <unistd.h>

namespace dfdyn::tools {

enum class RemovalState : unsigned char { vacant, claimed, armed };
static_assert(std::atomic<RemovalState>::is_always_lock_free, "the signal handler reads it");

/// An entry of a list that only grows: a signal handler may neither allocate nor lock, and may run at any
/// time. Vacant entries are used again.
struct RemoveOnSignal::Slot {
    std::atomic<RemovalState> state = RemovalState::claimed;
    std::array<char, PATH_MAX> path{};
    Slot* next = nullptr;
};

namespace {

std::atomic<RemoveOnSignal::Slot*> first_slot = nullptr;
static_assert(std::atomic<RemoveOnSignal::Slot*>::is_always_lock_free, "the signal handler reads it");

/// Removes what `remove` can remove; returns whether there was any.
bool remove_armed(int (*remove)(const char*)) {
    bool any = false;
    for (const RemoveOnSignal::Slot* slot = first_slot.load(); slot != nullptr; slot = slot->next) {
        any = (slot->state.load() == RemovalState::armed && remove(slot->path.data()) == 0) || any;
    }
    return any;
}

extern "C" void remove_files_and_end(int signal_number) {
    remove_armed(::unlink);
    while (remove_armed(::rmdir)) { // a folder becomes empty when the folders in it are removed
    }
    // Not SA_RESETHAND: it restores the default action before the handler runs, and a second signal at that
    // moment ends the program with its files. This one is delivered when the handler returns.
    std::signal(signal_number, SIG_DFL);
    std::raise(signal_number);
}

void handle_unless_taken(int signal_number) {
    struct sigaction action {};
    if (::sigaction(signal_number, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) {
        return;
    }
    action.sa_handler = remove_files_and_end;
    sigfillset(&action.sa_mask);
    ::sigaction(signal_number, &action, nullptr);
}

RemoveOnSignal::Slot* claim_slot() {
    for (RemoveOnSignal::Slot* slot = first_slot.load(); slot != nullptr; slot = slot->next) {
        RemovalState vacant = RemovalState::vacant;
        if (slot->state.compare_exchange_strong(vacant, RemovalState::claimed)) {
            return slot;
        }
    }
    auto* const slot = new RemoveOnSignal::Slot; // never deleted: a handler may read it at any time
    slot->next = first_slot.load();
    while (!first_slot.compare_exchange_weak(slot->next, slot)) {
    }
    return slot;
}

} // namespace

RemoveOnSignal::RemoveOnSignal(const std::string& path) : slot_(claim_slot()) {
    if (path.size() >= slot_->path.size()) {
        return;
    }
    slot_->path.at(path.copy(slot_->path.data(), path.size())) = '\0';
    slot_->state = RemovalState::armed;
    for (const int signal_number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
        handle_unless_taken(signal_number);
    }
}

RemoveOnSignal::~RemoveOnSignal() { slot_->state = RemovalState::vacant; }

} // namespace dfdyn::tools
