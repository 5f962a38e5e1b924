// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/frame.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>

namespace dfdyn::hal {

/// Detects corrupted replies by their layout: which of the registers 0 to 3 and 15, in which order and types.
/// Other registers may change from reply to reply. A flipped bit in the header of a sub-frame assigns a value
/// to a wrong register. So a layout is accepted from its third reply on, the first one immediately. Up to
/// eight layouts are accepted in any order. O(1).
class MoteusLayouts {
  public:
    /// Takes the layout of a reply and returns true if it is accepted.
    constexpr bool take(std::uint32_t layout) noexcept {
        if (std::find(known_.begin(), known_.end(), layout) != known_.end()) {
            return true;
        }
        constexpr std::ptrdiff_t replies_before = 2;
        const bool counts = !any_ || std::count(doubtful_.begin(), doubtful_.end(), layout) >= replies_before;
        any_ = true;
        if (counts) {
            std::replace(doubtful_.begin(), doubtful_.end(), layout, none);
            known_[next_known_] = layout;
            next_known_ = (next_known_ + 1) % known_.size();
        } else {
            doubtful_[next_doubtful_] = layout;
            next_doubtful_ = (next_doubtful_ + 1) % doubtful_.size();
        }
        return counts;
    }

  private:
    static constexpr std::uint32_t none = 0;
    std::array<std::uint32_t, 8> known_{};
    std::array<std::uint32_t, 16> doubtful_{}; ///< two replies each of eight alternating layouts
    std::size_t next_known_ = 0;
    std::size_t next_doubtful_ = 0;
    bool any_ = false;
};

/// Reads the sub-frames of a moteus frame from front to back. Layout: mjbots/moteus, docs/protocol/can.md
/// (db1a762); little-endian:
/// - 0x00, 0x04, 0x08, 0x0C write, 0x10 … read, 0x20 … reply, as int8, int16, int32, float: number of
///   registers (two lowest bits, or the next varuint if they are 0), first register (varuint), for write and
///   reply the values.
/// - 0x30, 0x31 error: register, error (varuint). 0x40 … 0x42 a channel: number, length (varuint), bytes.
/// - 0x50 nothing.
class MoteusSubframes {
  public:
    /// Kind of access of a sub-frame to a register.
    enum class Kind : std::uint8_t { end, write, read, reply, malformed, unknown };

    /// One register of a frame.
    struct Item {
        Kind kind = Kind::end;    ///< kind of access
        std::uint32_t reg = 0;    ///< its number
        int type = 0;             ///< 0 int8, 1 int16, 2 int32, 3 float
        std::int32_t integer = 0; ///< of types 0 … 2
        float real = 0;           ///< of type 3
    };

    /// Reads this frame, which must outlive the reader.
    explicit constexpr MoteusSubframes(const Frame& frame) noexcept : frame_(frame) {}

    /// Returns the next register that is written, read or replied. O(remaining bytes).
    constexpr Item next() noexcept {
        while (left_ == 0) {
            if (at_ >= frame_.length) {
                return {};
            }
            if (const Kind fault = begin_subframe(); fault != Kind::end) {
                at_ = frame_.length;
                return {.kind = fault};
            }
        }
        Item item{.kind = kind_, .reg = register_++, .type = type_};
        --left_;
        if (kind_ != Kind::read && !load(item)) {
            left_ = 0;
            at_ = frame_.length;
            return {.kind = Kind::malformed};
        }
        return item;
    }

  private:
    /// Returns `end` if the sub-frame is well-formed so far.
    constexpr Kind begin_subframe() noexcept {
        const unsigned code = frame_.data[at_++];
        std::uint32_t first = 0;
        std::uint32_t second = 0;
        if (code == 0x50) {
            return Kind::end;
        }
        if (code == 0x30 || code == 0x31) {
            return varuint(first) && varuint(second) ? Kind::end : Kind::malformed;
        }
        if (code >= 0x40 && code <= 0x42) {
            const bool whole = varuint(first) && varuint(second) && (code == 0x42 || second <= room());
            at_ += whole && code != 0x42 ? second : 0;
            return whole ? Kind::end : Kind::malformed;
        }
        if (code >= 0x30) {
            return Kind::unknown;
        }
        kind_ = code < 0x10 ? Kind::write : code < 0x20 ? Kind::read : Kind::reply;
        type_ = static_cast<int>(code >> 2U & 3U);
        left_ = code & 3U;
        if ((left_ == 0 && !varuint(left_)) || !varuint(register_)) {
            left_ = 0;
            return Kind::malformed;
        }
        if (left_ > 64) { // more than any frame can carry
            left_ = 0;
            return Kind::malformed;
        }
        return Kind::end;
    }

    [[nodiscard]] constexpr std::uint32_t room() const noexcept {
        return static_cast<std::uint32_t>(frame_.length - at_);
    }

    constexpr bool varuint(std::uint32_t& value) noexcept {
        value = 0;
        for (unsigned shift = 0; shift < 35 && at_ < frame_.length; shift += 7) {
            const std::uint32_t byte = frame_.data[at_++];
            value |= (byte & 0x7FU) << shift;
            if ((byte & 0x80U) == 0) {
                return true;
            }
        }
        return false;
    }

    constexpr bool load(Item& item) noexcept {
        const std::uint32_t size = type_ == 0 ? 1 : type_ == 1 ? 2 : 4;
        if (room() < size) {
            return false;
        }
        const std::uint8_t* const bytes = frame_.data.data() + at_;
        at_ += size;
        switch (type_) {
        case 0:
            item.integer = bytes[0] < 0x80 ? bytes[0] : bytes[0] - 0x100;
            break;
        case 1:
            item.integer = load_little<std::int16_t>(bytes);
            break;
        case 2:
            item.integer = load_little<std::int32_t>(bytes);
            break;
        default:
            item.real = load_little<float>(bytes);
            break;
        }
        return true;
    }

    const Frame& frame_;
    std::uint32_t at_ = 0;
    Kind kind_ = Kind::end;
    int type_ = 0;
    std::uint32_t left_ = 0; ///< remaining registers of the current sub-frame
    std::uint32_t register_ = 0;
};

/// Appends bytes to a frame, which is padded with 0x50 to a length of CAN FD.
class MoteusWriter {
  public:
    /// Starts an empty frame with this identifier.
    explicit constexpr MoteusWriter(std::uint32_t id) noexcept {
        frame_ = make_frame(id, 0);
        frame_.extended = id > 0x7FF;
        frame_.fd = frame_.bit_rate_switch = true;
    }
    /// Appends bytes.
    constexpr void bytes(std::initializer_list<std::uint8_t> list) noexcept {
        for (const std::uint8_t byte : list) {
            frame_.data[frame_.length++] = byte;
        }
    }
    /// Appends a float, little-endian.
    constexpr void real(double value) noexcept {
        store_little(frame_.data.data() + frame_.length, static_cast<float>(value));
        frame_.length = static_cast<std::uint8_t>(frame_.length + 4);
    }
    /// Returns the frame, padded.
    constexpr Frame frame() noexcept {
        while (!is_frame_length(frame_.length, true)) {
            frame_.data[frame_.length++] = 0x50;
        }
        return frame_;
    }

  private:
    Frame frame_;
};

} // namespace dfdyn::hal
