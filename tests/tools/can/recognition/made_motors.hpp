// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/decoded.hpp"
#include "tests/tools/can/bus_check_support.hpp"

#include <cmath>
#include <cstring>
#include <numbers>
#include <span>

/// Frames of motors, written byte by byte from the protocols' documents, without the codecs. Joint k, from 1,
/// moves by 0.3 k - 0.9 + 0.5 sin(pi t + k) rad.
namespace dfdyn::tests::made {

using Bytes = std::vector<std::uint8_t>;

inline double angle(int k, double t) { return 0.3 * k - 0.9 + 0.5 * std::sin(std::numbers::pi * t + k); }
inline double speed(int k, double t) { return 0.5 * std::numbers::pi * std::cos(std::numbers::pi * t + k); }
inline double effort(int k, double t) { return (0.5 + 0.1 * k) * std::cos(0.5 * std::numbers::pi * t + k); }

/// Bus with frames in any order of their times.
class Log {
  public:
    void add(double time_s, std::uint32_t id, const Bytes& bytes, bool extended = false) {
        Frame frame = hal::make_frame(id, static_cast<int>(bytes.size()));
        frame.extended = extended;
        frame.stamp_ns = 1'700'000'000'000'000'000 + std::llround(1e9 * time_s);
        std::ranges::copy(bytes, frame.data.begin());
        frames_.push_back(frame);
    }
    Frames frames() const {
        Frames sorted = frames_;
        std::ranges::stable_sort(sorted, {}, &Frame::stamp_ns);
        return sorted;
    }

  private:
    Frames frames_;
};

inline unsigned code(double value, double maximum, int bits) {
    const double largest = (1 << bits) - 1;
    return static_cast<unsigned>(std::clamp((value + maximum) * largest / (2 * maximum) + 0.5, 0.0, largest));
}

inline std::uint8_t byte(unsigned value) { return static_cast<std::uint8_t>(value & 0xFFU); }

/// A feedback in MIT mode. `maxima`: of position, velocity and torque. `last`: bytes 6 and 7.
inline Bytes mit_feedback(unsigned first, int k, double t, const std::array<double, 3>& maxima,
                          const std::array<unsigned, 2>& last) {
    const unsigned position = code(angle(k, t), maxima[0], 16);
    const unsigned velocity = code(speed(k, t), maxima[1], 12);
    const unsigned torque = code(effort(k, t), maxima[2], 12);
    return {byte(first),
            byte(position >> 8U),
            byte(position),
            byte(velocity >> 4U),
            byte((velocity & 15U) << 4U | torque >> 8U),
            byte(torque),
            byte(last[0]),
            byte(last[1])};
}

/// A command in MIT mode of zero torque without stiffness and damping.
inline const Bytes neutral{0x7F, 0xFF, 0x7F, 0xF0, 0, 0, 0x07, 0xFF};
inline constexpr double spacing_s = 280e-6; ///< between motors

/// Adds `motors` enabled Damiao motors that are commanded at `rate_hz` from `begin_s` to `end_s` and answer
/// on 0x11, 0x12 … `every(k)`: motor k answers in each cycle that is a multiple of every(k).
template <class Every>
void add_damiao(Log& log, int motors, double rate_hz, double begin_s, double end_s, Every every) {
    const int cycles = static_cast<int>((end_s - begin_s) * rate_hz);
    for (int i = 0; i < cycles; ++i) {
        double t = begin_s + i / rate_hz;
        for (int k = 1; k <= motors; ++k) {
            const auto id = static_cast<unsigned>(k);
            if (i % every(k) == 0) {
                log.add(t, id, neutral);
                log.add(t + 140e-6, 0x10 + id,
                        mit_feedback(0x10 | id, k % 8, t + 140e-6, {12.5, 30, 10}, {31, 34}));
            }
            t += spacing_s;
        }
    }
}
inline void add_damiao(Log& log, int motors, double rate_hz, double begin_s, double end_s) {
    add_damiao(log, motors, rate_hz, begin_s, end_s, [](int) { return 1; });
}

/// CubeMars motors at 200 Hz for 2 s. `own`: they answer on the identifiers of their commands, from `first`;
/// else on 0.
inline Log cubemars(unsigned first, int motors, bool own, unsigned celsius) {
    Log log;
    for (int i = 0; i < 400; ++i) {
        double t = i / 200.0;
        for (int k = 1; k <= motors; ++k) {
            const unsigned motor = first + static_cast<unsigned>(k) - 1;
            log.add(t, motor, neutral);
            log.add(t + 200e-6, own ? motor : 0,
                    mit_feedback(motor, k, t + 200e-6, {12.5, 50, 18}, {celsius, 0}));
            t += spacing_s;
        }
    }
    return log;
}

template <class Number>
void append(Bytes& bytes, Number little_endian) {
    std::array<std::uint8_t, sizeof(Number)> raw{};
    std::memcpy(raw.data(), &little_endian, raw.size());
    bytes.insert(bytes.end(), raw.begin(), raw.end());
}

/// Adds an ODrive axis that sends its encoder at `rate_hz` and its heartbeat at 10 Hz, for 2 s.
inline void add_odrive(Log& log, unsigned node, int k, double rate_hz) {
    for (int i = 0; i < static_cast<int>(2 * rate_hz); ++i) {
        const double t = i / rate_hz + 2.1e-3 + 0.3e-3 * k;
        Bytes encoder;
        append(encoder, static_cast<float>(angle(k, t) / (2 * std::numbers::pi)));
        append(encoder, static_cast<float>(speed(k, t) / (2 * std::numbers::pi)));
        log.add(t, node << 5U | 9U, encoder);
    }
    for (int i = 0; i < 19; ++i) {
        log.add(0.05 + 0.1 * i, node << 5U | 1U, {0, 0, 0, 0, 8, 0, 0, 0});
    }
}

/// RMD motors 1 … 3 with V3 drivers that are polled for 0x92 and 0x9C at 250 Hz for 2 s; motor 1 is silent.
inline Log rmd_with_silent_motor() {
    Log log;
    for (int i = 0; i < 500; ++i) {
        double t = i / 250.0;
        for (unsigned k = 1; k <= 3; ++k) {
            const double degrees = angle(static_cast<int>(k), t) * 180 / std::numbers::pi;
            for (const unsigned command : {0x92U, 0x9CU}) {
                log.add(t, 0x140 + k, {byte(command), 0, 0, 0, 0, 0, 0, 0});
                Bytes answer = command == 0x92 ? Bytes{0x92, 0, 0, 0} : Bytes{0x9C, 33};
                if (command == 0x92) {
                    append(answer, static_cast<std::int32_t>(std::lround(100 * degrees)));
                } else {
                    append(answer, static_cast<std::int16_t>(50 + i % 7));
                    append(answer, static_cast<std::int16_t>(0));
                    append(answer, static_cast<std::int16_t>(std::lround(degrees)));
                }
                if (k > 1) {
                    log.add(t + 150e-6, 0x240 + k, answer);
                }
                t += spacing_s;
            }
        }
    }
    return log;
}

/// CANopen drives 1 … `nodes` at 250 Hz for 2 s: TPDO 1 with statusword, position and a torque of about 30
/// counts. `sync`: with a SYNC. `heartbeat`: with heartbeats. `amplitude_rad`: of the motion.
inline Log canopen(unsigned nodes, bool sync, bool heartbeat, double amplitude_rad = 0.2) {
    Log log;
    for (int i = 0; i < 500; ++i) {
        double t = i / 250.0;
        if (sync) {
            log.add(t, 0x080, {});
        }
        for (unsigned node = 1; node <= nodes; ++node) {
            t += 200e-6;
            const double turn =
                (0.3 * node + amplitude_rad * std::sin(std::numbers::pi * t)) / (2 * std::numbers::pi);
            Bytes pdo{0x37, 0x12};
            append(pdo, static_cast<std::int32_t>(turn * (1 << 20)));
            append(pdo, static_cast<std::int16_t>(29 + i % 3));
            log.add(t, 0x180 + node, pdo);
            if (heartbeat && i % 100 == 50) {
                log.add(t + 2e-3, 0x700 + node, {5});
            }
        }
    }
    return log;
}

} // namespace dfdyn::tests::made
