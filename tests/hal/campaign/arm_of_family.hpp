// SPDX-License-Identifier: Apache-2.0
// Configures the receiver for a family of tests/hal/families.
#pragma once

#include "dfdyn/hal/sample_assembly.hpp"
#include "tests/hal/campaign/arm.hpp"

#include <type_traits>

namespace dfdyn::tests {

/// Returns the frames of a family's devices: from its own encoder (`on_wire`), or else from the product's.
template <class Family>
struct OnWire {
    static auto boards() {
        if constexpr (requires { Family::on_wire::boards(); }) {
            return Family::on_wire::boards();
        } else {
            return Family::boards();
        }
    }
    static auto sensor() {
        if constexpr (requires { Family::on_wire::sensor(); }) {
            return Family::on_wire::sensor();
        } else {
            return Family::sensor();
        }
    }
    static std::vector<hal::Frame> status() {
        const auto list = [](const auto& frames) {
            return std::vector<hal::Frame>(frames.begin(), frames.end());
        };
        if constexpr (requires { Family::on_wire::status(); }) {
            return list(Family::on_wire::status());
        } else {
            return list(Family::other_frames());
        }
    }
    static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
        if constexpr (requires { Family::on_wire::frames(board, joints); }) {
            return Family::on_wire::frames(board, joints);
        } else {
            const auto all = boards();
            using Board = std::remove_cvref_t<decltype(all[0])>;
            std::array<hal::JointValue, static_cast<std::size_t>(Board::joints)> values{};
            for (std::size_t i = 0; i < values.size(); ++i) {
                values[i].position_rad = joints[values.size() * board + i].position_rad;
                values[i].effort = joints[values.size() * board + i].effort;
            }
            const hal::FrameList list = all[board].encode(values);
            return {list.frame, static_cast<std::size_t>(list.count)};
        }
    }
    static constexpr bool synchronous = [] {
        if constexpr (requires { Family::on_wire::synchronous; }) {
            return Family::on_wire::synchronous;
        } else {
            return false;
        }
    }();
};

inline hal::TrackConfig campaign_track() {
    return {.max_age_ns = bus_max_age,
            .latency_ns = 0,
            .qualification = {},
            .period_ns = bus_period,
            .jitter_ns = bus_track_jitter};
}

template <class Assembly>
class ReceivingAssembly : public ReceivingArm {
  public:
    ReceivingAssembly(Trigger trigger, const Assembly& assembly) : trigger_(trigger), assembly_(assembly) {}

    std::optional<std::int64_t> take(const hal::Frame& frame, std::int64_t now_ns) override {
        using Kind = hal::SampleTrigger::Kind;
        const hal::SampleTrigger moment = assembly_.take(frame, now_ns);
        const Kind wanted = trigger_ == Trigger::sync ? Kind::sync : Kind::set;
        return trigger_ != Trigger::timer && moment.kind == wanted ? std::optional(moment.instant_ns)
                                                                   : std::nullopt;
    }
    void update(hal::BusState state, const hal::BusCounters& counters) override {
        assembly_.update(state, counters);
    }
    [[nodiscard]] bool pending(std::int64_t instant_ns, std::int64_t now_ns) const override {
        return assembly_.pending(instant_ns, now_ns);
    }
    CampaignSample assemble(std::int64_t instant_ns, std::int64_t now_ns) override {
        const auto assembled = assembly_.assemble(instant_ns, now_ns);
        CampaignSample result;
        result.time_ns = assembled.sample.time_ns;
        result.valid = assembled.valid();
        result.output_valid = assembled.sample.output_valid;
        for (int i = 0; i < 2; ++i) {
            result.position[static_cast<std::size_t>(i)] = assembled.sample.position[i];
        }
        result.outputs = static_cast<std::size_t>(assembled.sample.output.size());
        for (std::size_t k = 0; k < result.outputs; ++k) {
            result.output[k] = assembled.sample.output[static_cast<int>(k)];
        }
        result.report.joint_reason = assembled.report.joint_reason;
        result.report.position_origin = assembled.report.position_origin;
        result.report.position_age_ns = assembled.report.position_age_ns;
        result.report.output = assembled.report.output;
        result.report.output_origin = assembled.report.output_origin;
        result.report.output_age_ns = assembled.report.output_age_ns;
        return result;
    }

  private:
    Trigger trigger_;
    Assembly assembly_;
};

/// Takes each joint's count and the position of its encoder's zero from the decoded frames of the boards.
template <class Boards>
void find_scales(Boards boards, CampaignArm& arm) {
    for (std::size_t board = 0; board < boards.size(); ++board) {
        const wire::Frames frames = arm.frames(board, {});
        for (std::size_t part = 0; part < frames.count; ++part) {
            const hal::Decoded decoded = boards[board].decode(frames.frame[part]);
            for (int i = 0; i < decoded.joints; ++i) {
                const hal::JointValue& value = decoded.joint[static_cast<std::size_t>(i)];
                const auto joint = static_cast<std::size_t>(value.joint);
                if (value.position_reason != hal::Reason::waiting_for_position) {
                    arm.step_rad[joint] = value.step_rad;
                    arm.zero_rad[joint] = value.position_rad - value.from_zero_rad;
                }
            }
        }
    }
}

/// An arm with these boards and an output.
template <class Family, class Output>
CampaignArm arm_with_output(const std::string& name, const Output& output) {
    const auto boards = OnWire<Family>::boards();
    using Board = std::remove_cvref_t<decltype(boards[0])>;
    using Assembly = hal::SampleAssembly<double, 2, Board, static_cast<int>(boards.size()), Output>;
    CampaignArm arm;
    arm.name = name;
    arm.synchronous = OnWire<Family>::synchronous;
    arm.boards = boards.size();
    arm.frames = [](std::size_t board, const wire::Joints& joints) {
        return OnWire<Family>::frames(board, joints);
    };
    arm.status = OnWire<Family>::status();
    arm.receive = [boards, output](Trigger trigger, const hal::MotionLimits& limits) {
        constexpr hal::Range range{-3.1, 3.1};
        const Assembly assembly({.board = boards,
                                 .position = campaign_track(),
                                 .position_range = {range, range},
                                 .clock = {},
                                 .limits = {limits, limits}},
                                output);
        return std::make_unique<ReceivingAssembly<Assembly>>(trigger, assembly);
    };
    arm.has_values = [boards, output](const hal::Frame& frame) {
        const auto carried = [](const hal::Decoded& decoded) {
            return decoded.kind == hal::Decoded::Kind::values || decoded.kind == hal::Decoded::Kind::part;
        };
        Output receiver = output;
        return carried(receiver.take(frame)) ||
               std::ranges::any_of(boards, [&](Board board) { return carried(board.decode(frame)); });
    };
    find_scales(boards, arm);
    if constexpr (requires { Family::on_wire::step_rad; }) {
        arm.step_rad.fill(Family::on_wire::step_rad);
    }
    arm.find_fields();
    return arm;
}

/// An arm with joints and a sensor.
template <class Joints, class Sensor>
CampaignArm arm_with_sensor(const std::string& name) {
    const auto sensor = OnWire<Sensor>::sensor();
    const double range = Sensor::on_wire::range;
    const hal::Range one{-range, range};
    const hal::WrenchOutput<std::remove_cvref_t<decltype(sensor)>, 16> output(
        sensor, {.track = campaign_track(),
                 .range = {one, one, one, one, one, one},
                 .pairing = {.period_ns = bus_period, .delay_ns = bus_period / 2},
                 .frozen_limit = 5});
    CampaignArm arm = arm_with_output<Joints>(name, output);
    arm.output_range = range;
    arm.output_step = range / 32768;
    arm.wrench = Sensor::on_wire::frames;
    arm.saturate_wrench = Sensor::on_wire::saturate;
    for (const hal::Frame& frame : OnWire<Sensor>::status()) {
        arm.status.push_back(frame);
    }
    return arm;
}

/// Returns one count of a board's effort; 0: it has none.
template <class Family>
double effort_step() {
    double least = 0;
    auto boards = OnWire<Family>::boards();
    const auto effort_of = [&](double effort) {
        wire::Joints joints{};
        joints[0].effort = effort;
        const wire::Frames frames = OnWire<Family>::frames(0, joints);
        std::optional<double> result;
        for (std::size_t part = 0; part < frames.count; ++part) {
            const hal::JointValue value = boards[0].decode(frames.frame[part]).joint[0];
            result = value.effort_reason == hal::Reason::no_output ? result : std::optional(value.effort);
        }
        return result;
    };
    for (double effort = 1; effort < 2; effort += 1e-4) {
        const auto one = effort_of(effort);
        const auto next = effort_of(effort + 1e-4);
        if (one && next && *one != *next && (least == 0 || std::abs(*next - *one) < least)) {
            least = std::abs(*next - *one);
        }
    }
    return least;
}

/// An arm whose joints measure their own efforts.
template <class Family>
CampaignArm arm_with_efforts(const std::string& name) {
    const hal::Range range{-40, 40};
    CampaignArm arm = arm_with_output<Family>(
        name, hal::EffortOutput<2, 16>({.track = campaign_track(), .range = {range, range}}));
    arm.output_step = effort_step<Family>();
    return arm;
}

} // namespace dfdyn::tests
