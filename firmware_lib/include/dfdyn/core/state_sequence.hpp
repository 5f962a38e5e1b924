// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

namespace dfdyn {

/// Lets one context copy a state that another context changes; typically the idle loop copies the state that
/// an interrupt learns.
///
/// This is a sequence lock (L. Lamport, "Concurrent reading and writing", 1977). The sequence is odd during a
/// change and a different even number afterwards, so that a copy during which the state changed is detected
/// and refused. A sequence lock alone would refuse every copy: a learner that learns in every tick leaves no
/// pause as long as a copy takes. The copying context can therefore request a hold, during which the ticking
/// context changes nothing. A hold expires after a number of ticks, so that a copying task that has crashed
/// does not stop learning forever; the sequence then advances, and a late copy is refused.
///
/// Neither context waits, and no interrupt is masked. Each variable is written by one context only, with
/// 32-bit loads and stores; no read-modify-write is needed, which a Cortex-M0 lacks. The handshake at the
/// start of a hold is from E. W. Dijkstra, "Solution of a problem in concurrent programming control" (1965):
/// each side sets its flag before it reads the other's, so that at least one side sees the other.
///
/// A copy of the object starts without a hold.
class StateSequence {
  public:
    StateSequence() noexcept = default;
    /// Starts without a hold, even if the other has one.
    StateSequence(const StateSequence& /*other*/) noexcept {}
    /// Assignment overwrites the state, so a copy in progress detects a change.
    StateSequence& operator=(const StateSequence& other) noexcept {
        if (this != &other) {
            begin_change();
            end_change();
        }
        return *this;
    }
    ~StateSequence() = default;

    // Called by the context that changes the state.

    /// Begins changes that `end_change` ends, in one tick or, with `ticks` = 0, between two ticks. Returns
    /// false during a hold: nothing may be changed.
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

    /// Begins a change regardless of a hold.
    void begin_change() noexcept {
        sequence_.store(sequence_.load(std::memory_order_relaxed) + 1, std::memory_order_seq_cst);
        std::atomic_thread_fence(std::memory_order_release);
    }
    /// Ends the changes that `try_change` or `begin_change` began.
    void end_change() noexcept {
        sequence_.store(sequence_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
    }

    // Called by the context that copies the state.

    /// Requests a hold of at most `max_ticks` > 0 ticks and returns its number. Replaces a hold that is
    /// active.
    [[nodiscard]] std::uint32_t hold(std::uint32_t max_ticks) noexcept {
        last_request_ = last_request_ + 1 == 0 ? 1 : last_request_ + 1;
        max_ticks_.store(max_ticks, std::memory_order_relaxed);
        request_.store(last_request_, std::memory_order_seq_cst);
        return last_request_;
    }
    /// Ends the hold with this number, if it is active.
    void release(std::uint32_t request) noexcept {
        if (request_.load(std::memory_order_relaxed) == request) {
            request_.store(0, std::memory_order_release);
        }
    }

    /// Returns the sequence before a copy. Odd: a change is in progress.
    [[nodiscard]] std::uint32_t read() const noexcept { return sequence_.load(std::memory_order_seq_cst); }
    /// Returns the sequence after a copy: the same as before if the copy is consistent.
    [[nodiscard]] std::uint32_t read_again() const noexcept {
        std::atomic_thread_fence(std::memory_order_acquire);
        return sequence_.load(std::memory_order_relaxed);
    }

  private:
    /// Counts `ticks` more ticks of the hold `asked`. Returns false once the hold has expired.
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
    /// The hold whose ticks are counted; used by the ticking context only.
    std::uint32_t held_request_ = 0;
    std::uint32_t held_ticks_ = 0; ///< ticks of that hold so far
    /// Number of the requested hold, or 0; written by the copying context.
    std::atomic<std::uint32_t> request_ = 0;
    std::atomic<std::uint32_t> max_ticks_ = 0;
    std::uint32_t last_request_ = 0; ///< used by the copying context only
};

} // namespace dfdyn
