// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/ati_netcan.hpp"
#include "dfdyn/hal/device/cia402.hpp"
#include "dfdyn/hal/device/icub_2foc.hpp"
#include "dfdyn/hal/device/icub_strain.hpp"
#include "dfdyn/hal/device/icub_two_joint_board.hpp"
#include "dfdyn/hal/device/odrive.hpp"
#include "dfdyn/hal/device/robotous_rft.hpp"
#include "tools/can/description/dbc_device.hpp"

#include <algorithm>
#include <array>
#include <type_traits>
#include <utility>
#include <variant>

namespace dfdyn::tools {

/// `use` of the variant's value. As std::visit, which throws for a variant without a value; these always have
/// one.
template <std::size_t index = 0, class Use, class Variant>
auto use_device(Use use, Variant& variant) noexcept {
    if constexpr (index + 1 < std::variant_size_v<std::remove_const_t<Variant>>) {
        if (variant.index() != index) {
            return use_device<index + 1>(use, variant);
        }
    }
    return use(*std::get_if<index>(&variant));
}

/// The place of a board that an arm does not have.
struct NoBoard {
    static constexpr int joints = 1;
    static hal::Decoded decode(const hal::Frame& /*frame*/) noexcept { return {}; }
    static bool claims(std::uint32_t /*id*/) noexcept { return false; }
    static hal::FrameList encode(const std::array<hal::JointValue, 1>& /*values*/) noexcept { return {}; }
};

/// A board of the HAL, or a joint of a DBC file, whichever: the family is chosen at run time, decoding and
/// encoding are the family's own.
class AnyBoard {
  public:
    using Device = std::variant<NoBoard, hal::icub::TwoJointBoard, hal::icub::FocBoard, hal::Cia402Drive,
                                hal::OdriveAxis, DbcJoint>;
    static constexpr int joints = 2;

    AnyBoard() = default;
    explicit AnyBoard(Device device) : device_(std::move(device)) {}

    hal::Decoded decode(const hal::Frame& frame) noexcept {
        return use_device([&](auto& device) { return device.decode(frame); }, device_);
    }
    [[nodiscard]] bool claims(std::uint32_t id) const noexcept {
        return use_device([&](const auto& device) { return device.claims(id); }, device_);
    }
    /// A board with one joint looks at the first value only.
    [[nodiscard]] hal::FrameList encode(const std::array<hal::JointValue, 2>& values) const noexcept {
        return use_device(
            [&]<class Board>(const Board& device) {
                std::array<hal::JointValue, static_cast<std::size_t>(Board::joints)> own;
                std::copy_n(values.begin(), own.size(), own.begin());
                return device.encode(own);
            },
            device_);
    }

    [[nodiscard]] const Device& device() const noexcept { return device_; }

  private:
    Device device_;
};

static_assert(hal::JointSource<AnyBoard>);

/// A force/torque sensor of the HAL, or of a DBC file, whichever.
class AnySensor {
  public:
    using Device = std::variant<hal::icub::StrainBoard, hal::RobotousRft, hal::AtiNetcan, DbcSensor>;

    explicit AnySensor(Device device) : device_(std::move(device)) {}

    hal::Decoded decode(const hal::Frame& frame) noexcept {
        return use_device([&](auto& device) { return device.decode(frame); }, device_);
    }
    [[nodiscard]] hal::WrenchReading wrench(const hal::Frame& first,
                                            const hal::Frame& second) const noexcept {
        return use_device([&](const auto& device) { return device.wrench(first, second); }, device_);
    }
    [[nodiscard]] bool claims(std::uint32_t id) const noexcept {
        return use_device([&](const auto& device) { return device.claims(id); }, device_);
    }
    [[nodiscard]] hal::FrameList encode(const hal::Wrench& value) const noexcept {
        return use_device([&](const auto& device) { return device.encode(value); }, device_);
    }

    [[nodiscard]] const Device& device() const noexcept { return device_; }

  private:
    Device device_;
};

static_assert(hal::WrenchSource<AnySensor>);

} // namespace dfdyn::tools
