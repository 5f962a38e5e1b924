// SPDX-License-Identifier: Apache-2.0
// The whole receive path of every family, compiled for a microcontroller without an operating system. It is
// compiled only: check_bare_metal.sh looks at what it would need.
#include "dfdyn/hal/assembly/effort_output.hpp"
#include "dfdyn/hal/assembly/wrench_output.hpp"
#include "dfdyn/hal/candump.hpp"
#include "dfdyn/hal/device/ati_netcan.hpp"
#include "dfdyn/hal/device/cia402.hpp"
#include "dfdyn/hal/device/icub_2foc.hpp"
#include "dfdyn/hal/device/icub_strain.hpp"
#include "dfdyn/hal/device/icub_two_joint_board.hpp"
#include "dfdyn/hal/device/odrive.hpp"
#include "dfdyn/hal/device/robotous_rft.hpp"
#include "dfdyn/hal/replay_bus.hpp"
#include "dfdyn/hal/sample_assembly.hpp"

/// A CAN controller's driver: the application's own.
struct BareController {
    std::span<const dfdyn::hal::Frame> drain(std::span<dfdyn::hal::Frame> into) noexcept {
        return into.first(0);
    }
    dfdyn::hal::SendResult send(const dfdyn::hal::Frame& /*frame*/) noexcept {
        return dfdyn::hal::SendResult::sent;
    }
    std::int64_t now_ns() const noexcept { return 0; }
    dfdyn::hal::BusState state() const noexcept { return dfdyn::hal::BusState::active; }
    const dfdyn::hal::BusCounters& counters() const noexcept { return counted; }
    dfdyn::hal::BusCounters counted{};
};
static_assert(dfdyn::hal::Bus<BareController>);

namespace {

using namespace dfdyn::hal;

constexpr std::int64_t ms = 1'000'000;
constexpr TrackConfig track{.max_age_ns = 3 * ms, .latency_ns = 0, .qualification = {}};
constexpr Range joint_range{-3, 3};

template <class Sensor>
constexpr WrenchOutput<Sensor, 8> wrench_of(const Sensor& sensor) {
    return {sensor,
            {.track = track,
             .range = {{{-9, 9}, {-9, 9}, {-9, 9}, {-9, 9}, {-9, 9}, {-9, 9}}},
             .pairing = {.period_ns = ms, .delay_ns = ms / 2},
             .frozen_limit = 100}};
}

template <class Board, int boards, class Output>
using Arm = SampleAssembly<float, 2, Board, boards, Output, 8>;

template <class Assembly>
typename Assembly::Config config_of(const decltype(Assembly::Config::board)& boards) {
    return {.board = boards,
            .position = track,
            .position_range = {joint_range, joint_range},
            .clock = {},
            .output_bus = 0};
}

template <class Assembly>
bool tick(Assembly& arm, BareController& controller) {
    static std::array<Frame, 16> room;
    arm.drain(controller, room);
    return arm.assemble(controller.now_ns() - ms, controller.now_ns()).valid();
}

} // namespace

/// One tick of each; whether all have a sample.
bool tick_all(BareController& controller) {
    using Icub = Arm<icub::TwoJointBoard, 1, WrenchOutput<icub::StrainBoard, 8>>;
    static Icub icub_arm(config_of<Icub>({icub::TwoJointBoard(1, {0, 11.375, 0}, {1, 11.375, 0})}),
                         wrench_of(icub::StrainBoard(13)));
    using Foc = Arm<icub::FocBoard, 2, WrenchOutput<RobotousRft, 8>>;
    static Foc foc_arm(config_of<Foc>({icub::FocBoard({.address = 1, .joint = 0}),
                                       icub::FocBoard({.address = 2, .joint = 1})}),
                       wrench_of(RobotousRft(RobotousRft::Config{})));
    using Drives = Arm<Cia402Drive, 2, EffortOutput<2, 8>>;
    static Drives drives(
        config_of<Drives>({Cia402Drive({.node = 1, .joint = 0}), Cia402Drive({.node = 2, .joint = 1})}),
        EffortOutput<2, 8>({.track = track, .range = {joint_range, joint_range}}));
    using Axes = Arm<OdriveAxis, 2, WrenchOutput<AtiNetcan, 8>>;
    static Axes axes(
        config_of<Axes>({OdriveAxis({.node = 1, .joint = 0}), OdriveAxis({.node = 2, .joint = 1})}),
        wrench_of(AtiNetcan(AtiNetcan::Config{})));
    return tick(icub_arm, controller) && tick(foc_arm, controller) && tick(drives, controller) &&
           tick(axes, controller);
}

/// A log in memory, played on a board.
bool play(std::string_view line) { return parse_candump_line(line).kind == CandumpLine::Kind::frame; }
