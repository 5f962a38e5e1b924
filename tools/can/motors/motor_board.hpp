// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/motor_command.hpp"
#include "tools/can/description/any_device.hpp"
#include "tools/can/motors/host_watch.hpp"
#include "tools/can/motors/velocity_check.hpp"

#include <cmath>
#include <string>

namespace dfdyn::tools {

/// Advice for a motor whose velocities contradict its positions.
struct ScaleAdvice {
    const char* confirm;
    const char* fix;
};

/// Finding for such a motor; none if they agree. `joint` counts from 0.
std::vector<BusFinding> velocity_findings(const VelocityCheck& check, int joint, const ScaleAdvice& advice);

/// A board with one motor that reports velocities and is commanded by a host. `Derived` has
/// - `static ScaleAdvice advice()`;
/// - `bool takes_torque() const`: false if the description lacks what a torque command needs.
template <class Derived, class Codec>
class MotorBoard : public BoardOf<Derived, Codec> {
  public:
    using Base = BoardOf<Derived, Codec>;
    using Base::Base;
    using Base::codec;
    /// True if answers to commands have no position.
    static constexpr bool needs_polls = false;

    hal::Decoded decode(const hal::Frame& frame) noexcept override {
        const hal::MotorCommand command = codec().command(frame);
        if (command != hal::MotorCommand::none) {
            host_.take(command, codec().decode_torque(frame).has_value(), frame.stamp_ns);
        }
        const hal::Decoded decoded = Base::decode(frame);
        if (decoded.kind == hal::Decoded::Kind::values) {
            velocity_.take(decoded.joint[0]);
        }
        return decoded;
    }
    bool measures_effort() const override { return true; }
    double encoder_turn_rad() const override {
        return Base::encoder_turn_rad() / std::abs(codec().config().motor_per_joint);
    }
    std::optional<hal::Frame> torque_command(int /*joint*/, double torque_Nm) const override {
        return derived().takes_torque() ? std::optional(codec().encode_torque(torque_Nm)) : std::nullopt;
    }
    std::optional<double> commanded_torque(int /*joint*/, const hal::Frame& frame) const override {
        return derived().takes_torque() ? codec().decode_torque(frame) : std::nullopt;
    }
    std::vector<BusFinding> findings() const override {
        const int joint = codec().config().joint;
        std::vector<BusFinding> findings = velocity_findings(velocity_, joint, Derived::advice());
        for (BusFinding& finding : host_.findings(name(), Derived::needs_polls)) {
            findings.push_back(std::move(finding));
        }
        return findings;
    }
    std::string host_summary() const override { return host_.summary(); }
    bool carries_no_values(const hal::Frame& frame) const override {
        if constexpr (requires { codec().carries_no_values(frame); }) {
            return codec().carries_no_values(frame);
        }
        return false;
    }

    const VelocityCheck& velocity() const noexcept { return velocity_; }

  protected:
    HostWatch& host() noexcept { return host_; }

  private:
    const Derived& derived() const noexcept { return static_cast<const Derived&>(*this); }
    std::string name() const { return "the motor of joint " + std::to_string(codec().config().joint + 1); }

    VelocityCheck velocity_;
    HostWatch host_;
};

} // namespace dfdyn::tools
