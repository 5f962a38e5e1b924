// SPDX-License-Identifier: Apache-2.0
#include "tools/can/arm/bus_arm.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

hal::TrackConfig track_config(const BusSource& source) {
    return {.max_age_ns = source.max_age_ns,
            .latency_ns = source.latency_ns,
            .qualification = {},
            .period_ns = std::llround(1e9 / source.rate_hz),
            .jitter_ns = source.jitter_ns};
}

hal::ClockGate::Config clock_config(const BusDescription& description) {
    hal::ClockGate::Config config;
    const double slowest_hz = std::min(description.joints.rate_hz, description.output.rate_hz);
    config.max_step_ns = std::max(config.max_step_ns, static_cast<std::int64_t>(3e9 / slowest_hz));
    return config;
}

/// Returns the output's settings that both kinds of it have.
template <class Output>
typename Output::Config output_config(const BusDescription& description) {
    typename Output::Config config{};
    config.track = track_config(description.output);
    std::ranges::copy(description.output_range, config.range.begin());
    config.frozen_limit = description.frozen_after;
    return config;
}

} // namespace

BusOutput::BusOutput(const BusDescription& description)
    : output_([&]() -> decltype(output_) {
          if (description.sensor) {
              auto config = output_config<Wrench>(description);
              config.pairing = description.pairing;
              return Wrench(*description.sensor, config);
          }
          auto config = output_config<Efforts>(description);
          config.joints = {description.joint_count};
          return Efforts(config);
      }()) {}

Extent<dynamic> BusOutput::size() const noexcept {
    return std::visit([](const auto& output) { return Extent<dynamic>{output.size()}; }, output_);
}

hal::Decoded BusOutput::take(const hal::Frame& frame) noexcept {
    return std::visit([&](auto& output) { return output.take(frame); }, output_);
}

void BusOutput::take(const hal::JointValue& value, std::optional<double> position_rad) noexcept {
    std::visit([&](auto& output) { output.take(value, position_rad); }, output_);
}

bool BusOutput::claims(std::uint32_t id) const noexcept {
    return std::visit([&](const auto& output) { return output.claims(id); }, output_);
}

hal::Measurement<hal::places(dynamic)> BusOutput::at(std::int64_t instant_ns, std::int64_t now_ns) noexcept {
    return std::visit(
        [&](auto& output) {
            const auto measured = output.at(instant_ns, now_ns);
            hal::Measurement<hal::places(outputs)> all{measured.stamp_ns, measured.reason, {}};
            std::ranges::copy(measured.value, all.value.begin());
            return all;
        },
        output_);
}

hal::ValueOrigin BusOutput::origin(std::int64_t instant_ns) const noexcept {
    return std::visit([&](const auto& output) { return output.origin(instant_ns); }, output_);
}

bool BusOutput::pending(std::int64_t instant_ns, std::int64_t now_ns) const noexcept {
    return std::visit([&](const auto& output) { return output.pending(instant_ns, now_ns); }, output_);
}

bool BusOutput::heard() const noexcept {
    return std::visit([](const auto& output) { return output.heard(); }, output_);
}

std::int64_t BusOutput::newest_ns() const noexcept {
    return std::visit([](const auto& output) { return output.newest_ns(); }, output_);
}

std::int64_t BusOutput::period_ns() const noexcept {
    return std::visit([](const auto& output) { return output.period_ns(); }, output_);
}

void BusOutput::lost() noexcept {
    std::visit([](auto& output) { output.lost(); }, output_);
}

const AnySensor* BusOutput::sensor() const noexcept {
    const auto* wrench = std::get_if<Wrench>(&output_);
    return wrench != nullptr ? &wrench->source() : nullptr;
}

BusArm::BusArm(const BusDescription& description)
    : trigger_(description.trigger), assembly_(config_of(description), BusOutput(description)) {}

BusArm::Assembly::Config BusArm::config_of(const BusDescription& description) {
    Assembly::Config config{.board = {},
                            .position = track_config(description.joints),
                            .position_range = {},
                            .clock = clock_config(description),
                            .limits = {},
                            .joints = {description.joint_count}};
    std::ranges::transform(description.boards, config.board.begin(), &BusBoard::board);
    std::ranges::copy(description.joint_limits, config.limits.begin());
    config.position_range.fill({-description.position_limit_rad, description.position_limit_rad});
    return config;
}

std::optional<std::int64_t> BusArm::take(const hal::Frame& frame, std::int64_t now_ns) {
    using Kind = hal::SampleTrigger::Kind;
    const hal::SampleTrigger moment = assembly_.take(frame, now_ns);
    const bool sync = moment.kind == Kind::sync && trigger_ == BusTrigger::sync;
    const bool set = moment.kind == Kind::set && trigger_ == BusTrigger::set;
    return sync || set ? std::optional(moment.instant_ns) : std::nullopt;
}

std::vector<hal::Frame> BusArm::requests() const {
    return sensor() != nullptr ? (*sensor())->requests() : std::vector<hal::Frame>();
}

} // namespace dfdyn::tools
