// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/snapshot.hpp"
#include "dfdyn/state_sequence.hpp"

namespace dfdyn {

/// Takes a snapshot of an estimator in pieces of any size while another context, such as a timer's interrupt,
/// goes on ticking it. Firmware writes it page by page from the idle loop:
///
///     SnapshotWriter writer(estimator);
///     while (writer.result() == SnapshotResult::in_progress) {
///         flash.append(page, writer.next(page)); // the interrupt ticks and predicts meanwhile
///     }
///     // ok: what is in flash is a snapshot for `Estimator::restore`
///
/// From its construction until the last part of the state is copied the estimator predicts in every tick, but
/// does not learn: its samples are counted as `Reason::learning_held`, and a sample that is half learned is
/// finished afterwards. So every piece is of the same moment. Copying within the ticks instead would need no
/// such pause, but would charge every tick for a thing that happens once a day; and letting the learner go on
/// would need a second state in memory.
///
/// The pause is bounded: after `max_held_ticks` ticks learning goes on, whatever has become of this object,
/// and an unfinished snapshot is refused as `changed`; so is one during which the estimator was reset or
/// restored. The checksum comes last and only if the state did not change: pieces of a refused snapshot are
/// no snapshot.
///
/// One context takes snapshots. No interrupt is masked and nobody waits. Each `next` takes O(bytes of its
/// piece
/// + columns), no heap.
template <class Estimator>
class SnapshotWriter {
  public:
    /// 10 s at 1 kHz: 32 bytes a tick save a state of 320 kB.
    static constexpr std::uint32_t default_held_ticks = 10'000;

    /// Asks the estimator to hold what it has learned for at most `max_held_ticks` > 0. It must outlive this
    /// object.
    explicit SnapshotWriter(Estimator& estimator, std::uint32_t max_held_ticks = default_held_ticks) noexcept
        : estimator_(&estimator), bytes_(dfdyn::snapshot_bytes(estimator)),
          hold_(estimator.sequence_.hold(max_held_ticks)) {}
    SnapshotWriter(const SnapshotWriter&) = delete;
    SnapshotWriter& operator=(const SnapshotWriter&) = delete;
    ~SnapshotWriter() { release(); }

    /// Writes the next bytes of the snapshot to the front of `piece` and returns how many. 0 where nothing is
    /// left to write (see `result`), or for once where a tick is under way on another core.
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

    /// Writes at most `max_bytes` more to where they belong in `buffer`, of at least `bytes()`, which must be
    /// the same in every call. Returns `result()`.
    SnapshotResult step(std::span<std::byte> buffer, std::size_t max_bytes) noexcept {
        if (result_ == SnapshotResult::in_progress && buffer.size() < bytes_) {
            cancel(SnapshotResult::wrong_size);
        }
        if (result_ == SnapshotResult::in_progress) {
            static_cast<void>(next(buffer.subspan(position_, std::min(max_bytes, bytes_ - position_))));
        }
        return result_;
    }

    /// `in_progress`, or what has become of the snapshot: `ok` when all of it is written, otherwise why there
    /// is none.
    [[nodiscard]] SnapshotResult result() const noexcept { return result_; }
    /// Of the whole snapshot, and those written so far.
    [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
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

    /// Whether the state is still that of the first piece. A tick that began before the hold, or has found
    /// the hold used up, may be under way: then it is too early to say, and `now` is one more than an even
    /// number.
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

    /// Copies header and state. The hold ends with the last byte of the state, if all were of the same
    /// moment.
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

    /// Writes the checksum, of a state that is known to be of one moment.
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
    bool holding_ = true; ///< the state is not copied yet
    bool begun_ = false;  ///< `first_sequence_` is known
};

} // namespace dfdyn
