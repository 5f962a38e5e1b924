// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

namespace dfdyn {

/// Lets one context copy a state that another one changes: typically the idle loop copies what an interrupt's
/// ticks learn.
///
/// It is a sequence lock (L. Lamport, "Concurrent reading and writing", 1977): the sequence is odd while the
/// state changes and another even number afterwards, so that a copy during which it changed is found out and
/// refused. That alone would refuse every copy: a learner that learns in every tick leaves no quiet time as
/// long as a copy takes. So the copying context can also ask for a hold, during which the ticking context
/// changes nothing. A hold ends by itself after a number of ticks, so that a copying task that died does not
/// stop learning for good; the sequence then goes on, and the late copy is refused.
///
/// Nobody ever waits, and no interrupt is masked. Each variable is written by one context only, with loads
/// and stores of 32 bits; no read-modify-write is needed, which a Cortex-M0 does not have. The handshake at
/// the start of a hold is that of E. W. Dijkstra, "Solution of a problem in concurrent programming control"
/// (1965): each side sets its mark before it looks at the other's, so that at least one sees the other.
///
/// A copy of a sequence belongs to a copy of the state: it is not held, and nobody waits for it.
class StateSequence {
  public:
    StateSequence() noexcept = default;
    StateSequence(const StateSequence& /*other*/) noexcept {}
    /// The state is overwritten: whoever copies it sees a change.
    StateSequence& operator=(const StateSequence& other) noexcept {
        if (this != &other) {
            begin_change();
            end_change();
        }
        return *this;
    }
    ~StateSequence() = default;

    // The context that changes the state.

    /// Begins changes that `end_change` ends, in one tick or (`ticks` = 0) between two. False: a hold is on,
    /// and nothing may be changed.
    [[nodiscard]] bool try_change(std::uint32_t ticks = 1) noexcept {
        const std::uint32_t asked = request_.load(std::memory_order_acquire);
        if (asked != 0 && holds(asked, ticks)) {
            return false;
        }
        begin_change();
        const std::uint32_t now = request_.load(std::memory_order_seq_cst);
        if (now == asked || now == 0) {
            return true;
        }
        sequence_.store(sequence_.load(std::memory_order_relaxed) - 1, std::memory_order_seq_cst);
        return false;
    }

    /// Begins a change that no hold delays.
    void begin_change() noexcept {
        sequence_.store(sequence_.load(std::memory_order_relaxed) + 1, std::memory_order_seq_cst);
        std::atomic_thread_fence(std::memory_order_release);
    }
    void end_change() noexcept {
        sequence_.store(sequence_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
    }

    // The context that copies the state.

    /// Asks for a hold of at most `max_ticks` > 0 and returns its number. A hold that is on already ends.
    [[nodiscard]] std::uint32_t hold(std::uint32_t max_ticks) noexcept {
        last_request_ = last_request_ + 1 == 0 ? 1 : last_request_ + 1;
        max_ticks_.store(max_ticks, std::memory_order_relaxed);
        request_.store(last_request_, std::memory_order_seq_cst);
        return last_request_;
    }
    /// Ends the hold with this number, unless it has ended.
    void release(std::uint32_t request) noexcept {
        if (request_.load(std::memory_order_relaxed) == request) {
            request_.store(0, std::memory_order_release);
        }
    }

    /// Present sequence, before a copy is begun. Odd: a change is under way.
    [[nodiscard]] std::uint32_t read() const noexcept { return sequence_.load(std::memory_order_seq_cst); }
    /// Present sequence, after a copy: the same as before if the copy is whole.
    [[nodiscard]] std::uint32_t read_again() const noexcept {
        std::atomic_thread_fence(std::memory_order_acquire);
        return sequence_.load(std::memory_order_relaxed);
    }

  private:
    /// Counts the ticks of the hold that `asked` began. False when they are used up.
    bool holds(std::uint32_t asked, std::uint32_t ticks) noexcept {
        held_ticks_ = asked == held_request_ ? held_ticks_ : 0;
        held_request_ = asked;
        if (held_ticks_ >= max_ticks_.load(std::memory_order_relaxed)) {
            return false;
        }
        held_ticks_ += ticks;
        return true;
    }

    std::atomic<std::uint32_t> sequence_ = 0; ///< written by the ticking context
    std::uint32_t held_request_ = 0;          ///< the hold whose ticks are counted; ticking context only …
    std::uint32_t held_ticks_ = 0;            ///< … and how many they are
    std::atomic<std::uint32_t> request_ =
        0; ///< number of the hold asked for, or 0; written by the copying one
    std::atomic<std::uint32_t> max_ticks_ = 0;
    std::uint32_t last_request_ = 0; ///< copying context only
};

} // namespace dfdyn
