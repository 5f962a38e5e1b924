// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/snapshot.hpp"
#include "dfdyn/core/state_sequence.hpp"

namespace dfdyn {

/// Takes a snapshot of an estimator in pieces of any size while another context, such as a timer interrupt,
/// keeps ticking it. Firmware can write it page by page from the idle loop:
///
///     SnapshotWriter writer(estimator);
///     while (writer.result() == SnapshotResult::in_progress) {
///         flash.append(page, writer.next(page)); // the interrupt ticks and predicts meanwhile
///     }
///     // ok: flash contains a snapshot for `Estimator::restore`
///
/// From the construction of the writer until the last part of the state is copied, the estimator predicts in
/// every tick but does not learn. Its samples are counted as `Reason::learning_held`; a half-learned sample
/// is finished afterwards. All pieces therefore belong to the same state. The alternatives cost more: a copy
/// within the ticks would load every tick for a rare event, and learning during the copy would need a second
/// state in memory.
///
/// The pause is bounded: after `max_held_ticks` ticks learning continues in any case, and the unfinished
/// snapshot is refused as `changed`. The same holds if the estimator was reset or restored during the copy.
/// The checksum is written last, and only if the state did not change, so the pieces of a refused snapshot
/// are not a valid snapshot.
///
/// Only one context may take snapshots. No interrupt is masked, and neither context waits for the other. Each
/// `next` takes O(bytes of its piece + columns) and no heap.
template <class Estimator>
class SnapshotWriter {
  public:
    /// 10 s at 1 kHz: at 32 bytes per tick this suffices for a state of 320 kB.
    static constexpr std::uint32_t default_held_ticks = 10'000;

    /// Requests that the estimator does not learn for at most `max_held_ticks` > 0 ticks. The estimator must
    /// outlive this object.
    explicit SnapshotWriter(Estimator& estimator, std::uint32_t max_held_ticks = default_held_ticks) noexcept
        : estimator_(&estimator), bytes_(dfdyn::snapshot_bytes(estimator)),
          hold_(estimator.sequence_.hold(max_held_ticks)) {}
    SnapshotWriter(const SnapshotWriter&) = delete;
    SnapshotWriter& operator=(const SnapshotWriter&) = delete;
    ~SnapshotWriter() { release(); }

    /// Writes the next bytes of the snapshot to the front of `piece` and returns their number. Returns 0 if
    /// nothing is left to write (see `result`), or once if a tick is in progress on another core.
    [[nodiscard]] std::size_t next(std::span<std::byte> piece) noexcept {
        if (result_ != SnapshotResult::in_progress || (holding_ && !unchanged(sequence().read()))) {
            return 0;
        }
        const std::size_t before = position_;
        if (holding_) {
            copy(piece);
        }
        if (!holding_) {
            finish(piece.subspan(position_ - before));
        }
        return position_ - before;
    }

    /// Writes at most `max_bytes` more bytes to their position in `buffer`, which holds at least `bytes()`
    /// and must be the same in every call. Returns `result()`.
    SnapshotResult step(std::span<std::byte> buffer, std::size_t max_bytes) noexcept {
        if (result_ == SnapshotResult::in_progress && buffer.size() < bytes_) {
            cancel(SnapshotResult::wrong_size);
        }
        if (result_ == SnapshotResult::in_progress) {
            static_cast<void>(next(buffer.subspan(position_, std::min(max_bytes, bytes_ - position_))));
        }
        return result_;
    }

    /// Returns `in_progress`, `ok` after the whole snapshot is written, or the reason of the failure.
    [[nodiscard]] SnapshotResult result() const noexcept { return result_; }
    /// Returns the size of the whole snapshot, in bytes.
    [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
    /// Returns the number of bytes written so far.
    [[nodiscard]] std::size_t written() const noexcept { return position_; }

  private:
    [[nodiscard]] StateSequence& sequence() noexcept { return estimator_->sequence_; }
    [[nodiscard]] std::size_t checked_bytes() const noexcept { return bytes_ - sizeof(SnapshotChecksum); }

    void release() noexcept {
        sequence().release(hold_);
        holding_ = false;
    }
    void cancel(SnapshotResult why) noexcept {
        release();
        result_ = why;
    }

    /// Returns true if the state has not changed since the first piece. A tick that began before the hold, or
    /// after the hold expired, may still be in progress; `now` is then one more than an even number, and the
    /// decision is deferred.
    bool unchanged(std::uint32_t now) noexcept {
        if (!begun_ && now % 2 == 0) {
            begun_ = true;
            first_sequence_ = now;
        }
        if (begun_ && now - first_sequence_ > 1) {
            cancel(SnapshotResult::changed);
        }
        return begun_ && now == first_sequence_;
    }

    /// Copies header and state. Ends the hold after the last byte of the state if all pieces are of the same
    /// state.
    void copy(std::span<std::byte> piece) noexcept {
        const std::span<std::byte> copied = piece.first(std::min(piece.size(), checked_bytes() - position_));
        std::span<std::byte> rest = copied;
        if (position_ < sizeof(SnapshotHeader)) {
            const SnapshotHeader header = detail::snapshot_header(estimator_->model_identity(), bytes_);
            const std::size_t count = std::min(rest.size(), sizeof header - position_);
            std::memcpy(rest.data(), std::as_bytes(std::span(&header, 1)).data() + position_, count);
            rest = rest.subspan(count);
        }
        if (!rest.empty()) {
            const std::size_t place = position_ + copied.size() - rest.size();
            detail::SnapshotSlice slice(place - sizeof(SnapshotHeader), rest);
            Estimator::visit_state(*static_cast<const Estimator*>(estimator_), slice);
        }
        checksum_ = crc32(copied, checksum_);
        position_ += copied.size();
        if (position_ == checked_bytes() && unchanged(sequence().read_again())) {
            release();
        }
    }

    /// Writes the checksum of a state that is known to be consistent.
    void finish(std::span<std::byte> piece) noexcept {
        if (result_ != SnapshotResult::in_progress) {
            return;
        }
        const std::size_t count = std::min(piece.size(), bytes_ - position_);
        std::memcpy(piece.data(),
                    std::as_bytes(std::span(&checksum_, 1)).data() + (position_ - checked_bytes()), count);
        position_ += count;
        result_ = position_ == bytes_ ? SnapshotResult::ok : result_;
    }

    Estimator* estimator_;
    std::size_t bytes_;
    std::size_t position_ = 0;
    std::uint32_t first_sequence_ = 0;
    SnapshotChecksum checksum_ = 0;
    SnapshotResult result_ = SnapshotResult::in_progress;
    std::uint32_t hold_;
    bool holding_ = true; ///< the state is not completely copied yet
    bool begun_ = false;  ///< `first_sequence_` is valid
};

} // namespace dfdyn
