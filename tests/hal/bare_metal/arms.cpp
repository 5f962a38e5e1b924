// SPDX-License-Identifier: Apache-2.0
// The whole receive path of every device family, compiled for a microcontroller without an operating system.
// It is never run: check_bare_metal.sh inspects the symbols that it needs.
#include "dfdyn/hal/assembly/effort_output.hpp"
#include "dfdyn/hal/assembly/wrench_output.hpp"
#include "dfdyn/hal/candump.hpp"
#include "dfdyn/hal/replay_bus.hpp"
#include "dfdyn/hal/sample_assembly.hpp"
#include "every_family.hpp"

/// Placeholder for the driver of a CAN controller, which the application provides.
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

template <class Board, std::size_t boards, class Output>
auto arm_of(const std::array<Board, boards>& board, const Output& output) {
    using Arm = SampleAssembly<float, 2, Board, static_cast<int>(boards), Output, 8>;
    return Arm({.board = board, .position = track, .position_range = {joint_range, joint_range}, .clock = {}},
               output);
}

template <class Family>
auto arm_with() {
    if constexpr (dfdyn::tests::JointFamily<Family>) {
        return arm_of(Family::boards(),
                      EffortOutput<2, 8>({.track = track, .range = {joint_range, joint_range}}));
    } else {
        return arm_of(dfdyn::tests::boards_of<Family>(), wrench_of(Family::sensor()));
    }
}

template <class Family>
bool tick(BareController& controller) {
    static auto arm = arm_with<Family>();
    static std::array<Frame, 16> room;
    arm.drain(controller, room);
    return arm.assemble(controller.now_ns() - ms, controller.now_ns()).valid();
}

template <class... Family>
struct Families {
    static bool tick_all(BareController& controller) { return (tick<Family>(controller) && ...); }
};

} // namespace

/// Runs one tick of each arm. Returns true if all have a sample.
bool tick_all(BareController& controller) {
    return dfdyn::tests::EveryFamily<Families>::tick_all(controller);
}

/// Parses a log line in memory, as for a playback on a board.
bool play(std::string_view line) { return parse_candump_line(line).kind == CandumpLine::Kind::frame; }
