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

/// What makes a multiplexed value be in a frame: the multiplexor's raw value is in one of the ranges.
struct DbcCondition {
    hal::Signal multiplexor;
    std::vector<DbcValueRange> ranges;

    [[nodiscard]] bool holds(const hal::Frame& frame) const noexcept;
    /// Whether no frame can meet both: of one multiplexor, without a common value.
    [[nodiscard]] bool excludes(const DbcCondition& other) const noexcept;
};

/// A value in the frames of a user's DBC file, in the arm's unit: the factor and offset of `signal`, and
/// `limits`, include the user's own.
struct DbcField {
    std::uint32_t id = 0;
    bool extended = false;
    int length = 0; ///< of the message, bytes
    hal::Signal signal;
    std::optional<hal::Range> limits;     ///< of the DBC file; beyond them the signal says something else
    std::vector<DbcCondition> conditions; ///< the value is there where all hold; none: in every frame

    /// Whether the frame is of this message, whatever its form.
    [[nodiscard]] bool is_in(const hal::Frame& frame) const noexcept;
    /// Of a frame of this message: a data frame of its length, classic or CAN FD.
    [[nodiscard]] hal::Reason check(const hal::Frame& frame) const noexcept;
    /// Whether a frame of this message and length has the value.
    [[nodiscard]] bool is_there(const hal::Frame& frame) const noexcept;
    /// Whether one frame may carry both.
    [[nodiscard]] bool shares_frames_with(const DbcField& other) const noexcept;

    [[nodiscard]] std::uint64_t raw(const hal::Frame& frame) const noexcept;
    [[nodiscard]] double value(const hal::Frame& frame) const noexcept;
    /// Not a number, or beyond the limits.
    [[nodiscard]] bool is_void(double value) const noexcept;
    /// Whether an integer is at an end of its bits.
    [[nodiscard]] bool is_at_end(const hal::Frame& frame) const noexcept;
};

struct DbcValue {
    const DbcField* field = nullptr;
    double value = 0;
};

/// The frames that carry the values, at most `into.size()`, which should not be smaller than `values.size()`;
/// returns how many. Values share a frame where they can.
std::size_t encode_fields(std::span<const DbcValue> values, std::span<hal::Frame> into) noexcept;

/// A joint whose position, and perhaps effort, a DBC file describes. Several joints may share a message.
class DbcJoint {
  public:
    static constexpr int joints = 1;

    struct Config {
        int joint = 0;
        DbcField position;
        std::optional<DbcField> effort;
        bool claims_position = true; ///< false: another joint with the same identifier does
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

/// A force/torque sensor that a DBC file describes: six values in two frames, which are two messages, or one
/// that is multiplexed. An integer at an end of its bits is taken for saturated.
class DbcSensor {
  public:
    /// fx fy fz mx my mz.
    explicit DbcSensor(const std::array<DbcField, 6>& fields) noexcept;

    /// Whether the fields are in just two frames.
    [[nodiscard]] static bool can_be(const std::array<DbcField, 6>& fields) noexcept;

    [[nodiscard]] bool claims(std::uint32_t id) const noexcept;
    [[nodiscard]] hal::Decoded decode(const hal::Frame& frame) const noexcept;
    [[nodiscard]] hal::WrenchReading wrench(const hal::Frame& first, const hal::Frame& second) const noexcept;
    [[nodiscard]] hal::FrameList encode(const hal::Wrench& value) const noexcept;

  private:
    /// Of a frame of this sensor.
    [[nodiscard]] bool is_first(const hal::Frame& frame) const noexcept;

    std::array<DbcField, 6> fields_;
    DbcField second_; ///< the first of the fields in the second frame
};

static_assert(hal::WrenchSource<DbcSensor>);

} // namespace dfdyn::tools
