// SPDX-License-Identifier: Apache-2.0
// Every family on a bus: how the product is configured for it, and what its devices send.
#pragma once

#include "dfdyn/hal/device/ati_netcan.hpp"
#include "dfdyn/hal/device/cia402.hpp"
#include "dfdyn/hal/device/icub_2foc.hpp"
#include "dfdyn/hal/device/icub_strain.hpp"
#include "dfdyn/hal/device/icub_two_joint_board.hpp"
#include "dfdyn/hal/device/odrive.hpp"
#include "dfdyn/hal/device/robotous_rft.hpp"
#include "dfdyn/hal/sample_assembly.hpp"
#include "tests/hal/campaign/truth.hpp"
#include "tests/hal/campaign/wire.hpp"

#include <vector>

namespace dfdyn::tests {

enum class Trigger { timer, set, sync };

/// Times of the campaign's buses.
constexpr std::int64_t bus_us = 1000;
constexpr std::int64_t bus_period = 2000 * bus_us;
constexpr std::int64_t bus_jitter = 200 * bus_us; ///< of a frame behind its device's measurement
constexpr std::int64_t bus_track_jitter = bus_jitter + 50 * bus_us; ///< as the description has it
constexpr std::int64_t bus_max_age = 3 * bus_period;
constexpr std::int64_t timer_delay = 3 * bus_period / 2;

/// What the robot's file says about the joints: twice what they do.
constexpr hal::MotionLimits own_limits{2 * Truth::most_velocity, 2 * Truth::most_acceleration};

/// A frame, and what it is.
struct Sent {
    enum class Role { sync, joints, wrench, status, noise };
    hal::Frame frame;
    std::int64_t true_ns = 0; ///< when it was on the wire
    Role role = Role::noise;
    int unit = 0; ///< joint or board, from 0; half of a wrench
    int cycle = 0;
    std::int64_t clock_ns = 0; ///< by which the clock of the stamps had been set
};
using Traffic = std::vector<Sent>;

/// Numbers that do not change while a bus runs.
struct Scene {
    Truth truth;
    std::int64_t start_ns = 0;
    std::mt19937_64* engine = nullptr;

    [[nodiscard]] double noise(double counts) const {
        return std::uniform_real_distribution<double>(-counts, counts)(*engine);
    }
    [[nodiscard]] std::int64_t jitter() const {
        return std::uniform_int_distribution<std::int64_t>(0, bus_jitter)(*engine);
    }
    [[nodiscard]] std::int64_t cycle_ns(int cycle) const { return start_ns + cycle * bus_period; }
};

inline hal::TrackConfig campaign_track() {
    return {.max_age_ns = bus_max_age,
            .latency_ns = 0,
            .qualification = {},
            .period_ns = bus_period,
            .jitter_ns = bus_track_jitter};
}

template <class Sensor>
hal::WrenchOutput<Sensor, 16> campaign_wrench(const Sensor& sensor, double range) {
    const hal::Range one{-range, range};
    return {sensor,
            {.track = campaign_track(),
             .range = {one, one, one, one, one, one},
             .pairing = {.period_ns = bus_period, .delay_ns = bus_period / 2},
             .frozen_limit = 5}};
}

inline hal::EffortOutput<2, 16> campaign_efforts() {
    return hal::EffortOutput<2, 16>({.track = campaign_track(), .range = {hal::Range{-40, 40}, {-40, 40}}});
}

template <class Assembly>
typename Assembly::Config campaign_config(const decltype(Assembly::Config::board)& boards,
                                          const hal::MotionLimits& limits) {
    constexpr double range = 3.1;
    return {.board = boards,
            .position = campaign_track(),
            .position_range = {hal::Range{-range, range}, hal::Range{-range, range}},
            .clock = {},
            .output_bus = 0,
            .limits = {limits, limits}};
}

inline void send(Traffic& traffic, hal::Frame frame, std::int64_t time_ns, Sent::Role role, int unit,
                 int cycle) {
    frame.stamp_ns = time_ns;
    traffic.push_back({frame, time_ns, role, unit, cycle});
}

/// A wrench in counts of a sensor whose range is `rail` counts, with the noise of its last bits.
inline wire::SixWords load_counts(const Scene& scene, std::int64_t time_ns, double rail) {
    wire::SixWords raw{};
    for (std::size_t k = 0; k < 6; ++k) {
        raw[k] = std::llround(rail * scene.truth.load(k, seconds_of(time_ns)) + scene.noise(2));
    }
    return raw;
}

inline void send_wrench(const Scene& scene, int cycle, const std::array<hal::Frame, 2>& halves,
                        std::int64_t measured_ns, Traffic& traffic) {
    const std::int64_t first_ns = measured_ns + scene.jitter();
    send(traffic, halves[0], first_ns, Sent::Role::wrench, 0, cycle);
    send(traffic, halves[1], first_ns + 130 * bus_us, Sent::Role::wrench, 1, cycle);
}

constexpr double degrees = 180 / std::numbers::pi;
constexpr double turn = 2 * std::numbers::pi;
constexpr std::int64_t wrench_phase = 600 * bus_us;
inline std::int64_t joint_phase(int joint) { return 100 * bus_us + 130 * bus_us * joint; }

/// One iCub board with both joints, and the strain sensor.
struct IcubArm {
    static constexpr const char* name = "icub_two_joint_board, icub_strain";
    static constexpr bool efforts = false;
    static constexpr bool synchronous = false;
    static constexpr double step = 1 / (91.0 * degrees);
    static constexpr double output_range = 500;
    using Board = hal::icub::TwoJointBoard;
    using Assembly = hal::SampleAssembly<double, 2, Board, 1, hal::WrenchOutput<hal::icub::StrainBoard, 16>>;

    static Assembly make(const hal::MotionLimits& limits) {
        return {campaign_config<Assembly>({Board(1, {0, -91.0, 20}, {1, 91.0, 0})}, limits),
                campaign_wrench(hal::icub::StrainBoard(0x0D), 500)};
    }
    static void start(const Scene& scene, Traffic& traffic) {
        for (unsigned channel = 0; channel < 6; ++channel) {
            send(traffic, wire::strain_full_scale(0x0D, channel, 500), scene.start_ns, Sent::Role::status, 9,
                 0);
        }
    }
    static void cycle(const Scene& scene, int k, Traffic& traffic) {
        const std::int64_t now = scene.cycle_ns(k);
        const std::int64_t measured = now + joint_phase(0);
        const double t = seconds_of(measured);
        send(traffic,
             wire::icub_positions(1, (scene.truth.position(0, t) * degrees + 20) * -91.0,
                                  scene.truth.position(1, t) * degrees * 91.0),
             measured + scene.jitter(), Sent::Role::joints, 0, k);
        send_wrench(scene, k, wire::strain(0x0D, load_counts(scene, now + wrench_phase, 0x8000)),
                    now + wrench_phase, traffic);
    }
};

/// Two 2FOC boards that send currents too.
struct FocArm {
    static constexpr const char* name = "icub_2foc, efforts";
    static constexpr bool efforts = true;
    static constexpr bool synchronous = false;
    static constexpr double step = turn / 65536 / 2;
    static constexpr double output_range = 0;
    using Board = hal::icub::FocBoard;
    using Assembly = hal::SampleAssembly<double, 2, Board, 2, hal::EffortOutput<2, 16>>;

    static std::array<Board, 2> boards() {
        return {Board({.address = 3, .joint = 0, .motor_per_joint = 2}),
                Board({.address = 4, .joint = 1, .motor_per_joint = -2, .zero_rad = 0.4})};
    }
    static Assembly make(const hal::MotionLimits& limits) {
        return {campaign_config<Assembly>(boards(), limits), campaign_efforts()};
    }
    static void start(const Scene& /*scene*/, Traffic& /*traffic*/) {}
    static void joints(const Scene& scene, int k, Traffic& traffic) {
        for (int i = 0; i < 2; ++i) {
            const std::int64_t measured = scene.cycle_ns(k) + joint_phase(i);
            const double t = seconds_of(measured);
            const auto joint = static_cast<std::size_t>(i);
            const double q = scene.truth.position(joint, t);
            send(traffic,
                 wire::foc_motion(static_cast<unsigned>(3 + i),
                                  scene.truth.effort(joint, t) + scene.noise(2e-3),
                                  i == 0 ? 2 * q / turn : -2 * (q - 0.4) / turn),
                 measured + scene.jitter(), Sent::Role::joints, i, k);
        }
    }
    static void cycle(const Scene& scene, int k, Traffic& traffic) { joints(scene, k, traffic); }
};

/// The same with a Robotous sensor.
struct FocWrenchArm {
    static constexpr const char* name = "icub_2foc, robotous_rft";
    static constexpr bool efforts = false;
    static constexpr bool synchronous = false;
    static constexpr double step = FocArm::step;
    static constexpr double output_range = 32768.0 / 50;
    using Assembly =
        hal::SampleAssembly<double, 2, FocArm::Board, 2, hal::WrenchOutput<hal::RobotousRft, 16>>;

    static Assembly make(const hal::MotionLimits& limits) {
        return {
            campaign_config<Assembly>(FocArm::boards(), limits),
            campaign_wrench(hal::RobotousRft({.counts_per_newton = 50, .counts_per_newton_metre = 50}), 655)};
    }
    static void start(const Scene& /*scene*/, Traffic& /*traffic*/) {}
    static void cycle(const Scene& scene, int k, Traffic& traffic) {
        FocArm::joints(scene, k, traffic);
        const std::int64_t measured = scene.cycle_ns(k) + wrench_phase;
        send_wrench(scene, k, wire::robotous(load_counts(scene, measured, 0x8000)), measured, traffic);
    }
};

/// Two CiA 402 drives; with a SYNC they measure at it.
struct DriveArm {
    static constexpr const char* name = "cia402, efforts";
    static constexpr bool efforts = true;
    static constexpr bool synchronous = true; ///< values belong to the SYNC before
    static constexpr double step = turn / 1048576;
    static constexpr double output_range = 0;
    using Board = hal::Cia402Drive;
    using Assembly = hal::SampleAssembly<double, 2, Board, 2, hal::EffortOutput<2, 16>>;

    static Board drive(int node, int joint, int bits, bool synchronous, double zero_rad = 0) {
        const double per_turn = bits == 16 ? 65536 : 1048576;
        const int length = bits / 8 + 2;
        return Board({.node = node,
                      .joint = joint,
                      .position_pdo = 0x280,
                      .position_length = length,
                      .position = {.start_bit = 0,
                                   .length = bits,
                                   .encoding = hal::Encoding::signed_integer,
                                   .factor = turn / per_turn,
                                   .offset = zero_rad},
                      .effort_pdo = 0x280,
                      .effort_length = length,
                      .effort = {.start_bit = bits,
                                 .length = 16,
                                 .encoding = hal::Encoding::signed_integer,
                                 .factor = 1e-3},
                      .synchronous = synchronous});
    }
    static Assembly make(const hal::MotionLimits& limits) {
        return {campaign_config<Assembly>({drive(1, 0, 32, true), drive(2, 1, 32, true)}, limits),
                campaign_efforts()};
    }
    static void start(const Scene& /*scene*/, Traffic& /*traffic*/) {}
    template <class Pdo>
    static void joints(const Scene& scene, int k, bool sync, double per_turn, Pdo pdo, Traffic& traffic) {
        const std::int64_t now = scene.cycle_ns(k);
        if (sync) {
            send(traffic, wire::sync(), now, Sent::Role::sync, 0, k);
        }
        for (int i = 0; i < 2; ++i) {
            const std::int64_t on_wire = now + joint_phase(i) + 150 * bus_us;
            const double t = seconds_of(sync ? now : on_wire);
            const auto joint = static_cast<std::size_t>(i);
            send(traffic,
                 pdo(static_cast<unsigned>(1 + i), scene.truth.position(joint, t) / turn * per_turn,
                     1000 * scene.truth.effort(joint, t) + scene.noise(2)),
                 on_wire + scene.jitter(), Sent::Role::joints, i, k);
        }
    }
    static void cycle(const Scene& scene, int k, Traffic& traffic) {
        joints(scene, k, true, 1048576, wire::drive_pdo, traffic);
    }
};

/// Drives without a SYNC.
struct FreeDriveArm : DriveArm {
    static constexpr const char* name = "cia402 without SYNC, efforts";
    static constexpr bool synchronous = false;
    static Assembly make(const hal::MotionLimits& limits) {
        return {campaign_config<Assembly>({drive(1, 0, 32, false), drive(2, 1, 32, false)}, limits),
                campaign_efforts()};
    }
    static void cycle(const Scene& scene, int k, Traffic& traffic) {
        joints(scene, k, false, 1048576, wire::drive_pdo, traffic);
    }
};

/// Drives with 16 bits of position, which go round at half a turn: it happens all the time.
struct WrappingArm : DriveArm {
    static constexpr const char* name = "cia402 with 16 bits, efforts";
    static constexpr double step = turn / 65536;

    /// The encoders are mounted so that they go round in the middle of the motion.
    static constexpr double mounting_rad = 2.9;
    static Assembly make(const hal::MotionLimits& limits) {
        return {campaign_config<Assembly>(
                    {drive(1, 0, 16, true, -mounting_rad), drive(2, 1, 16, true, -mounting_rad)}, limits),
                campaign_efforts()};
    }
    static void cycle(const Scene& scene, int k, Traffic& traffic) {
        const auto pdo = [](unsigned node, double counts, double torque) {
            return wire::drive_pdo_16(node, counts + mounting_rad / turn * 65536, torque);
        };
        joints(scene, k, true, 65536, pdo, traffic);
    }
};

/// Two ODrive axes and an ATI sensor, whose heartbeat says that the encoders are good.
struct OdriveArm {
    static constexpr const char* name = "odrive, ati_netcan";
    static constexpr bool efforts = false;
    static constexpr bool synchronous = false;
    static constexpr double step = 2e-6;
    static constexpr double output_range = 512;
    using Board = hal::OdriveAxis;
    using Assembly = hal::SampleAssembly<double, 2, Board, 2, hal::WrenchOutput<hal::AtiNetcan, 16>>;

    static Assembly make(const hal::MotionLimits& limits) {
        hal::AtiNetcan::Config ati;
        for (std::size_t i = 0; i < 6; ++i) {
            ati.matrix[i][i] = 1;
        }
        ati.counts_per_newton = ati.counts_per_newton_metre = 64;
        return {campaign_config<Assembly>(
                    {Board({.node = 1, .joint = 0}), Board({.node = 2, .joint = 1, .motor_per_joint = -8})},
                    limits),
                campaign_wrench(hal::AtiNetcan(ati), 512)};
    }
    static void start(const Scene& /*scene*/, Traffic& /*traffic*/) {}
    static void cycle(const Scene& scene, int k, Traffic& traffic) {
        const std::int64_t now = scene.cycle_ns(k);
        for (int i = 0; i < 2; ++i) {
            const std::int64_t measured = now + joint_phase(i);
            const double t = seconds_of(measured);
            const auto joint = static_cast<std::size_t>(i);
            const double ratio = i == 0 ? 1 : -8;
            if (k % 50 == 0) {
                send(traffic, wire::odrive_heartbeat(static_cast<unsigned>(1 + i), 0), now + 20 * bus_us,
                     Sent::Role::status, i, k);
            }
            send(traffic,
                 wire::odrive_estimates(static_cast<unsigned>(1 + i),
                                        ratio * scene.truth.position(joint, t) / turn,
                                        ratio * scene.truth.velocity(joint, t) / turn),
                 measured + scene.jitter(), Sent::Role::joints, i, k);
        }
        send_wrench(scene, k, wire::ati(load_counts(scene, now + wrench_phase, 0x8000)), now + wrench_phase,
                    traffic);
    }
};

} // namespace dfdyn::tests
