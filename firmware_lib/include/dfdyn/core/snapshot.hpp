// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/checksum.hpp"
#include "dfdyn/core/strict_math.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

namespace dfdyn {

/// Result of writing or reading a snapshot. Every result but `ok` means that nothing was changed.
enum class SnapshotResult : std::uint8_t {
    ok = 0,
    /// The buffer is smaller than the snapshot, or the snapshot has another size than this state.
    wrong_size = 1,
    /// The magic number is missing, or the byte order differs.
    not_a_snapshot = 2,
    wrong_version = 3, ///< written by another version of the format
    /// From an estimator with other sizes, another scalar type or other constants.
    wrong_model = 4,
    /// Wrong checksum, or the content is not a valid state.
    corrupted = 5,
    /// The state changed during the copy, so the copy is inconsistent; take another.
    changed = 6,
    in_progress = 7, ///< not finished yet (`SnapshotWriter`)
};

/// Header of a snapshot, in the machine's byte order. The parts of the state follow, in the order of
/// `visit_state`, and then the CRC-32 of all preceding bytes. A snapshot can therefore be written
/// sequentially, and an unfinished one is rejected.
struct SnapshotHeader {
    static constexpr std::uint32_t expected_magic = 0x59444644; ///< "DFDY"
    static constexpr std::uint32_t expected_version = 6;        ///< of the format

    std::uint32_t magic = expected_magic;     ///< of a snapshot in this machine's byte order
    std::uint32_t version = expected_version; ///< of the format
    std::uint32_t model = 0;                  ///< `model_identity()` of the estimator that wrote it
    std::uint32_t payload_bytes = 0;          ///< of the state
};

using SnapshotChecksum = std::uint32_t;

namespace detail {

/// Visitors of a state. A state lists its parts once, in `visit_state`: each array, and each index with its
/// range. The visitors measure a snapshot, write it, check it completely before anything is changed, and read
/// it. `skips<T>(count)` returns true if the visitor skips the next `count` values of type T, so that a state
/// need not visit many small parts one by one.
class SnapshotMeasure {
  public:
    template <class T>
    constexpr bool skips(int count) noexcept {
        array(static_cast<const T*>(nullptr), count);
        return true;
    }
    template <class T>
    constexpr void array(const T* /*values*/, int count) noexcept {
        bytes_ += sizeof(T) * static_cast<std::size_t>(count);
    }
    template <class T>
    constexpr void positive_array(const T* values, int count) noexcept {
        array(values, count);
    }
    template <class T>
    constexpr void ranged(const T& value, T /*low*/, T /*high*/) noexcept {
        array(&value, 1);
    }
    [[nodiscard]] constexpr std::size_t bytes() const noexcept { return bytes_; }

  private:
    std::size_t bytes_ = 0;
};

/// Copies bytes of a state, beginning at offset `first`, until `into` is full.
class SnapshotSlice {
  public:
    SnapshotSlice(std::size_t first, std::span<std::byte> into) noexcept : before_(first), into_(into) {}

    template <class T>
    bool skips(int count) noexcept {
        const std::size_t bytes = sizeof(T) * static_cast<std::size_t>(count);
        if (before_ >= bytes) {
            before_ -= bytes;
            return true;
        }
        return into_.empty();
    }
    template <class T>
    void array(const T* values, int count) noexcept {
        static_assert(std::is_trivially_copyable_v<T>);
        if (skips<T>(count)) {
            return;
        }
        const std::span<const std::byte> bytes =
            std::as_bytes(std::span(values, static_cast<std::size_t>(count))).subspan(before_);
        const std::size_t copied = std::min(bytes.size(), into_.size());
        std::memcpy(into_.data(), bytes.data(), copied);
        into_ = into_.subspan(copied);
        before_ = 0;
    }
    template <class T>
    void positive_array(const T* values, int count) noexcept {
        array(values, count);
    }
    template <class T>
    void ranged(const T& value, T /*low*/, T /*high*/) noexcept {
        array(&value, 1);
    }

  private:
    std::size_t before_; ///< bytes still to skip
    std::span<std::byte> into_;
};

class SnapshotReader {
  public:
    explicit SnapshotReader(const std::byte* cursor) noexcept : cursor_(cursor) {}

    template <class T>
    static constexpr bool skips(int /*count*/) noexcept {
        return false;
    }
    template <class T>
    void array(T* values, int count) noexcept {
        static_assert(std::is_trivially_copyable_v<T>);
        const std::size_t bytes = sizeof(T) * static_cast<std::size_t>(count);
        std::memcpy(values, cursor_, bytes);
        cursor_ += bytes;
    }
    template <class T>
    void positive_array(T* values, int count) noexcept {
        array(values, count);
    }
    template <class T>
    void ranged(T& value, T /*low*/, T /*high*/) noexcept {
        array(&value, 1);
    }

  private:
    const std::byte* cursor_;
};

/// Checks without writing that every number is finite, every variance positive and every index in its range.
class SnapshotCheck {
  public:
    explicit SnapshotCheck(const std::byte* cursor) noexcept : reader_(cursor) {}

    template <class T>
    static constexpr bool skips(int /*count*/) noexcept {
        return false;
    }
    template <class T>
    void array(const T* /*values*/, int count) noexcept {
        for (int i = 0; i < count; ++i) {
            valid_ = std::isfinite(next<T>()) && valid_;
        }
    }
    template <class T>
    void positive_array(const T* /*values*/, int count) noexcept {
        for (int i = 0; i < count; ++i) {
            const T value = next<T>();
            valid_ = std::isfinite(value) && value > 0 && valid_;
        }
    }
    template <class T>
    void ranged(const T& /*value*/, T low, T high) noexcept {
        const T value = next<T>();
        valid_ = value >= low && value <= high && valid_;
    }
    [[nodiscard]] bool valid() const noexcept { return valid_; }

  private:
    template <class T>
    T next() noexcept {
        T value{};
        reader_.array(&value, 1);
        return value;
    }

    SnapshotReader reader_;
    bool valid_ = true;
};

} // namespace detail

/// Returns the size of a snapshot of `state`, in bytes.
template <class State>
std::size_t snapshot_bytes(const State& state) noexcept {
    detail::SnapshotMeasure measure;
    State::visit_state(state, measure);
    return sizeof(SnapshotHeader) + measure.bytes() + sizeof(SnapshotChecksum);
}

namespace detail {

/// Returns the header of a snapshot of `bytes` bytes.
inline SnapshotHeader snapshot_header(std::uint32_t model, std::size_t bytes) noexcept {
    SnapshotHeader header;
    header.model = model;
    header.payload_bytes =
        static_cast<std::uint32_t>(bytes - sizeof(SnapshotHeader) - sizeof(SnapshotChecksum));
    return header;
}

} // namespace detail

/// Writes `state`, marked with the identity of its model, to the front of `buffer`. Returns `wrong_size` if
/// the buffer is smaller than `snapshot_bytes(state)`. O(bytes).
template <class State>
SnapshotResult write_snapshot(const State& state, std::uint32_t model, std::span<std::byte> buffer) noexcept {
    const std::size_t bytes = snapshot_bytes(state);
    if (buffer.size() < bytes) {
        return SnapshotResult::wrong_size;
    }
    const std::span<std::byte> checked = buffer.first(bytes - sizeof(SnapshotChecksum));
    const SnapshotHeader header = detail::snapshot_header(model, bytes);
    std::memcpy(checked.data(), &header, sizeof header);
    detail::SnapshotSlice slice(0, checked.subspan(sizeof header));
    State::visit_state(state, slice);
    const SnapshotChecksum checksum = crc32(checked);
    std::memcpy(buffer.data() + checked.size(), &checksum, sizeof checksum);
    return SnapshotResult::ok;
}

/// Reads `state` from the front of `buffer`. A rejected snapshot changes nothing. O(bytes).
template <class State>
SnapshotResult read_snapshot(State& state, std::uint32_t model, std::span<const std::byte> buffer) noexcept {
    SnapshotHeader header;
    if (buffer.size() < sizeof header) {
        return SnapshotResult::wrong_size;
    }
    std::memcpy(&header, buffer.data(), sizeof header);
    if (header.magic != SnapshotHeader::expected_magic) {
        return SnapshotResult::not_a_snapshot;
    }
    if (header.version != SnapshotHeader::expected_version) {
        return SnapshotResult::wrong_version;
    }
    if (header.model != model) {
        return SnapshotResult::wrong_model;
    }
    const std::size_t bytes = snapshot_bytes(state);
    if (buffer.size() < bytes ||
        header.payload_bytes != detail::snapshot_header(model, bytes).payload_bytes) {
        return SnapshotResult::wrong_size;
    }
    const std::span<const std::byte> checked = buffer.first(bytes - sizeof(SnapshotChecksum));
    SnapshotChecksum checksum = 0;
    std::memcpy(&checksum, buffer.data() + checked.size(), sizeof checksum);
    detail::SnapshotCheck check(checked.data() + sizeof header);
    State::visit_state(state, check);
    if (checksum != crc32(checked) || !check.valid()) {
        return SnapshotResult::corrupted;
    }
    detail::SnapshotReader reader(checked.data() + sizeof header);
    State::visit_state(state, reader);
    return SnapshotResult::ok;
}

} // namespace dfdyn
