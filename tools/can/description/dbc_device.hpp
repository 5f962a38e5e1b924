// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bits.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/gate/range.hpp"
#include "tools/can/description/dbc.hpp"

#include <array>
#include <optional>
#include <span>
#include <utility>

namespace dfdyn::tools {

/// Condition for the presence of a multiplexed value: the multiplexor's raw value is in one of the ranges.
struct DbcCondition {
    hal::Signal multiplexor;
    std::vector<DbcValueRange> ranges;

    [[nodiscard]] bool holds(const hal::Frame& frame) const noexcept;
    /// Returns true if no frame meets both conditions: they have the same multiplexor and no common value.
    [[nodiscard]] bool excludes(const DbcCondition& other) const noexcept;
};

/// A value in the frames of a user's DBC file, in the unit of the arm. The factor and offset of `signal`, and
/// `limits`, include those of the user.
struct DbcField {
    std::uint32_t id = 0;
    bool extended = false;
    int length = 0; ///< bytes of the message
    hal::Signal signal;
    std::optional<hal::Range> limits; ///< limits in the DBC file; a value beyond them is not a measurement
    /// conditions that must all be true for the value to be present; empty: it is in every frame
    std::vector<DbcCondition> conditions;

    /// Returns true if the frame has the identifier of this message, in either format.
    [[nodiscard]] bool is_in(const hal::Frame& frame) const noexcept;
    /// Checks a frame of this message: it must be a data frame with the message's length, classic or CAN FD.
    [[nodiscard]] hal::Reason check(const hal::Frame& frame) const noexcept;
    /// Returns true if a frame of this message and length contains the value.
    [[nodiscard]] bool is_there(const hal::Frame& frame) const noexcept;
    /// Returns true if one frame can carry both values.
    [[nodiscard]] bool shares_frames_with(const DbcField& other) const noexcept;

    [[nodiscard]] std::uint64_t raw(const hal::Frame& frame) const noexcept;
    [[nodiscard]] double value(const hal::Frame& frame) const noexcept;
    /// Returns true if the value is not a number or beyond the limits.
    [[nodiscard]] bool is_void(double value) const noexcept;
    /// Returns true if an integer is at an end of its range.
    [[nodiscard]] bool is_at_end(const hal::Frame& frame) const noexcept;
};

struct DbcValue {
    const DbcField* field = nullptr;
    double value = 0;
};

/// Encodes the values into frames and returns the number of frames, at most `into.size()`, which should be at
/// least `values.size()`. Values share a frame if possible.
std::size_t encode_fields(std::span<const DbcValue> values, std::span<hal::Frame> into) noexcept;

/// A joint whose position, and optionally effort, is described in a DBC file. Several joints may share a
/// message.
class DbcJoint {
  public:
    static constexpr int joints = 1;

    struct Config {
        int joint = 0;
        DbcField position;
        std::optional<DbcField> effort;
        double count_rad = 0; ///< one count of the encoder, if the signal is finer; 0: that of the signal
        bool claims_position = true; ///< false: another joint with the same identifier claims it
        bool claims_effort = true;
    };

    explicit DbcJoint(Config config) noexcept : config_(std::move(config)) {}

    [[nodiscard]] const Config& config() const noexcept { return config_; }
    [[nodiscard]] bool claims(std::uint32_t id) const noexcept;
    [[nodiscard]] hal::Decoded decode(const hal::Frame& frame) const noexcept;
    [[nodiscard]] hal::FrameList encode(const std::array<hal::JointValue, 1>& values) const noexcept;

  private:
    Config config_;
};

static_assert(hal::JointSource<DbcJoint>);

/// A force/torque sensor that is described in a DBC file: six values in two frames, which are two messages or
/// two variants of a multiplexed one. An integer at an end of its range is considered saturated.
class DbcSensor {
  public:
    /// Order: fx fy fz mx my mz.
    explicit DbcSensor(std::array<DbcField, 6> fields) noexcept;

    /// Returns true if the fields are in exactly two frames.
    [[nodiscard]] static bool can_be(const std::array<DbcField, 6>& fields) noexcept;

    [[nodiscard]] bool claims(std::uint32_t id) const noexcept;
    [[nodiscard]] hal::Decoded decode(const hal::Frame& frame) const noexcept;
    [[nodiscard]] hal::WrenchReading wrench(const hal::Frame& first, const hal::Frame& second) const noexcept;
    [[nodiscard]] hal::FrameList encode(const hal::Wrench& value) const noexcept;

  private:
    /// Returns true if a frame of this sensor is the first of the two.
    [[nodiscard]] bool is_first(const hal::Frame& frame) const noexcept;

    std::array<DbcField, 6> fields_;
    DbcField second_; ///< the first field in the second frame
};

static_assert(hal::WrenchSource<DbcSensor>);

} // namespace dfdyn::tools
