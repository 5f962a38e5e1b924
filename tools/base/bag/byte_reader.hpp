// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/text/error.hpp"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace dfdyn::tools {

/// Reads numbers and texts from bytes, front to back, with every bound checked. `what` names the bytes in
/// messages: `run.mcap: message of /joint_states`.
class ByteReader {
  public:
    ByteReader(std::span<const std::byte> bytes, std::string what) : bytes_(bytes), what_(std::move(what)) {}

    std::size_t position() const { return position_; }
    std::size_t left() const { return bytes_.size() - position_; }

    /// Returns the next `count` bytes. Throws InputError if there are fewer.
    std::span<const std::byte> take(std::uint64_t count) {
        if (count > left()) {
            throw error(std::to_string(count) + " more bytes", std::to_string(left()));
        }
        const auto taken = bytes_.subspan(position_, static_cast<std::size_t>(count));
        position_ += taken.size();
        return taken;
    }

    /// Returns the next integer or floating-point number, in little-endian order unless `swapped`.
    template <class Number>
    Number number(bool swapped = false) {
        static_assert(std::is_arithmetic_v<Number> && std::endian::native == std::endian::little);
        std::byte raw[sizeof(Number)];
        const auto taken = take(sizeof(Number));
        for (std::size_t k = 0; k < sizeof(Number); ++k) {
            raw[k] = taken[swapped ? sizeof(Number) - 1 - k : k];
        }
        Number value{};
        std::memcpy(&value, raw, sizeof value);
        return value;
    }

    /// Returns the next text, which begins with its length (32 bits).
    std::string_view text() {
        const auto taken = take(number<std::uint32_t>());
        return {reinterpret_cast<const char*>(taken.data()), taken.size()};
    }

    /// Returns the error at the present position.
    InputError error(const std::string& expected, const std::string& found) const {
        return InputError(what_ + ": at byte " + std::to_string(position_) + ": expected " + expected +
                          ", found " + found);
    }

  private:
    std::span<const std::byte> bytes_;
    std::string what_;
    std::size_t position_ = 0;
};

} // namespace dfdyn::tools
