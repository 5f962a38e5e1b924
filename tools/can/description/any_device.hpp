// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/decoded.hpp"
#include "tools/can/description/bus_finding.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

/// A board with joints: a codec of the HAL, and the properties of its family that the program needs. The rest
/// of the program uses boards only through this interface; see families/.
class Board {
  public:
    virtual ~Board() = default;
    Board& operator=(const Board&) = delete;

    virtual std::unique_ptr<Board> clone() const = 0;

    /// Like hal::JointSource. A board with one joint uses only the first value.
    virtual hal::Decoded decode(const hal::Frame& frame) noexcept = 0;
    virtual bool claims(std::uint32_t id) const noexcept = 0;
    virtual bool concerns(const hal::Frame& frame) const noexcept = 0; ///< see hal::concerns
    virtual hal::FrameList encode(const std::array<hal::JointValue, 2>& values) const noexcept = 0;

    /// True if its frames carry efforts.
    virtual bool measures_effort() const { return false; }
    /// Distance (rad) of the joint between the positions at which the encoder wraps: one encoder turn.
    virtual double encoder_turn_rad() const { return 2 * std::numbers::pi; }
    /// Status frame that the device sends by itself; none for most families.
    virtual std::optional<hal::Frame> heartbeat() const { return std::nullopt; }
    /// Time after which its values require another heartbeat; 0: none is required.
    virtual std::int64_t heartbeat_timeout_ns() const { return 0; }
    /// Findings from all decoded frames together.
    virtual std::vector<BusFinding> findings() const { return {}; }
    /// True for a frame on an identifier of its values that carries none: a request of the host, or another
    /// answer. It does not come at the rate of the values.
    virtual bool carries_no_values(const hal::Frame& /*frame*/) const { return false; }
    /// Commands of other programs to its motor, as `12 control, 3 poll`; empty: none.
    virtual std::string host_summary() const { return {}; }

    /// Encodes a torque command (N·m) for the board's joint number `joint` (0 or 1); none if the family has
    /// no public command or its scale is unknown.
    virtual std::optional<hal::Frame> torque_command(int /*joint*/, double /*torque_Nm*/) const {
        return std::nullopt;
    }
    /// True if its torque command is in the unit of its efforts, which must then be N·m.
    virtual bool commands_efforts() const { return false; }
    /// Decodes the torque (N·m) that `frame` commands to this joint of the board; none for any other frame.
    virtual std::optional<double> commanded_torque(int /*joint*/, const hal::Frame& /*frame*/) const {
        return std::nullopt;
    }

  protected:
    Board() = default;
    Board(const Board&) = default;
};

/// A force/torque sensor: a codec of the HAL, and the properties of its family that the program needs.
class Sensor {
  public:
    virtual ~Sensor() = default;
    Sensor& operator=(const Sensor&) = delete;

    virtual std::unique_ptr<Sensor> clone() const = 0;

    /// Like hal::WrenchSource.
    virtual hal::Decoded decode(const hal::Frame& frame) noexcept = 0;
    virtual hal::WrenchReading wrench(const hal::Frame& first, const hal::Frame& second) const noexcept = 0;
    virtual bool claims(std::uint32_t id) const noexcept = 0;
    virtual bool concerns(const hal::Frame& frame) const noexcept = 0; ///< see hal::concerns
    virtual hal::FrameList encode(const hal::Wrench& value) const noexcept = 0;

    /// Returns ok if the calibration is known and plausible. Without it the sensor sends nothing.
    virtual hal::Reason calibration() const { return hal::Reason::ok; }
    /// Requests that the host sends to obtain a calibration that is unknown or in doubt; empty otherwise.
    virtual std::vector<hal::Frame> requests() const { return {}; }
    /// The sensor's reply to such a request; none for any other frame.
    virtual std::optional<hal::Frame> answer(const hal::Frame& /*request*/) const { return std::nullopt; }
    /// The replies to all requests.
    virtual std::vector<hal::Frame> answers() const { return {}; }
    /// True for a frame on an identifier of its values that carries none: a request of the host.
    virtual bool carries_no_values(const hal::Frame& /*frame*/) const { return false; }
    /// Findings about the sensor that no sample shows.
    virtual std::vector<BusFinding> findings() const { return {}; }

  protected:
    Sensor() = default;
    Sensor(const Sensor&) = default;
};

/// A board with the codec `Codec`. `Derived` is the class of the family, which overrides the defaults.
template <class Derived, hal::JointSource Codec>
class BoardOf : public Board {
  public:
    explicit BoardOf(Codec codec) : codec_(std::move(codec)) {}

    std::unique_ptr<Board> clone() const final {
        return std::make_unique<Derived>(static_cast<const Derived&>(*this));
    }
    hal::Decoded decode(const hal::Frame& frame) noexcept override { return codec_.decode(frame); }
    bool claims(std::uint32_t id) const noexcept final { return codec_.claims(id); }
    bool concerns(const hal::Frame& frame) const noexcept final { return hal::concerns(codec_, frame); }
    std::int64_t heartbeat_timeout_ns() const final {
        if constexpr (requires { codec_.config().heartbeat_timeout_ns; }) {
            return codec_.config().heartbeat_timeout_ns;
        } else {
            return 0;
        }
    }
    hal::FrameList encode(const std::array<hal::JointValue, 2>& values) const noexcept final {
        std::array<hal::JointValue, static_cast<std::size_t>(Codec::joints)> own;
        std::copy_n(values.begin(), own.size(), own.begin());
        return codec_.encode(own);
    }

    const Codec& codec() const noexcept { return codec_; }

  private:
    Codec codec_;
};

/// A sensor with the codec `Codec`. `Derived` is the class of the family, which overrides the defaults.
template <class Derived, hal::WrenchSource Codec>
class SensorOf : public Sensor {
  public:
    explicit SensorOf(Codec codec) : codec_(std::move(codec)) {}

    std::unique_ptr<Sensor> clone() const final {
        return std::make_unique<Derived>(static_cast<const Derived&>(*this));
    }
    hal::Decoded decode(const hal::Frame& frame) noexcept final { return codec_.decode(frame); }
    hal::WrenchReading wrench(const hal::Frame& first, const hal::Frame& second) const noexcept final {
        return codec_.wrench(first, second);
    }
    bool claims(std::uint32_t id) const noexcept final { return codec_.claims(id); }
    bool concerns(const hal::Frame& frame) const noexcept final { return hal::concerns(codec_, frame); }
    hal::FrameList encode(const hal::Wrench& value) const noexcept final { return codec_.encode(value); }

    const Codec& codec() const noexcept { return codec_; }

  private:
    Codec codec_;
};

/// Owns a Board or a Sensor of any family, with deep copies. Empty by default: a place without a device.
template <class Device>
class AnyDevice {
  public:
    AnyDevice() = default;
    explicit AnyDevice(std::unique_ptr<Device> device) noexcept : device_(std::move(device)) {}
    AnyDevice(const AnyDevice& other) : device_(other.device_ ? other.device_->clone() : nullptr) {}
    AnyDevice(AnyDevice&&) noexcept = default;
    AnyDevice& operator=(const AnyDevice& other) {
        device_ = other.device_ ? other.device_->clone() : nullptr;
        return *this;
    }
    AnyDevice& operator=(AnyDevice&&) noexcept = default;
    ~AnyDevice() = default;

    hal::Decoded decode(const hal::Frame& frame) noexcept {
        return device_ ? device_->decode(frame) : hal::Decoded{};
    }
    [[nodiscard]] bool claims(std::uint32_t id) const noexcept { return device_ && device_->claims(id); }
    [[nodiscard]] bool concerns(const hal::Frame& frame) const noexcept {
        return device_ && device_->concerns(frame);
    }

    /// Requires that it is not empty.
    const Device* operator->() const noexcept { return device_.get(); }
    const Device& operator*() const noexcept { return *device_; }

  private:
    std::unique_ptr<Device> device_;
};

/// A board of any family, as a hal::JointSource.
class AnyBoard : public AnyDevice<Board> {
  public:
    static constexpr int joints = 2;
    using AnyDevice::AnyDevice;

    [[nodiscard]] hal::FrameList encode(const std::array<hal::JointValue, 2>& values) const noexcept {
        return (*this)->encode(values);
    }
};

static_assert(hal::JointSource<AnyBoard>);

/// A sensor of any family, as a hal::WrenchSource.
class AnySensor : public AnyDevice<Sensor> {
  public:
    using AnyDevice::AnyDevice;

    [[nodiscard]] hal::WrenchReading wrench(const hal::Frame& first,
                                            const hal::Frame& second) const noexcept {
        return (*this)->wrench(first, second);
    }
    [[nodiscard]] hal::FrameList encode(const hal::Wrench& value) const noexcept {
        return (*this)->encode(value);
    }
};

static_assert(hal::WrenchSource<AnySensor>);

} // namespace dfdyn::tools
