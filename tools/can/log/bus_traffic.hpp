// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/arm/bus_wire.hpp"
#include "tools/can/arm/device_frames.hpp"

#include <filesystem>
#include <random>
#include <span>

namespace dfdyn::tools {

struct TrafficOptions {
    double jitter_us = 0; ///< maximum delay of the joints' frames and of wrenches, uniformly distributed
    std::uint64_t seed = 1;
    /// Sample period of rows whose times have jitter; 0: the times are exact. A source with a period of at
    /// most 1.5 times this value sends at every row, a slower one at the row closest to its time.
    double row_period_s = 0;
};

/// Simulates the frames that the devices of a bus description would have sent during a motion given row by
/// row. Frames have the quantisation of the devices and wait until the bus is free. Equal rows, description
/// and options give equal frames.
class BusTraffic {
  public:
    /// Time before the first row in which the devices boot and reply once to each request. Time stamps are
    /// the rows' times plus this.
    static constexpr std::int64_t lead_ns = 10'000'000;

    /// Throws like DeviceFrames.
    BusTraffic(const BusDescription& description, const TrafficOptions& options, BusWire::OnFrame on_frame);

    /// Adds the next row: positions (rad) and outputs (of the description's kind) at `time_ns`, which must be
    /// later than that of the last row. A source that is slower than the rows skips some.
    void add(std::int64_t time_ns, std::span<const double> position, std::span<const double> output);

    /// Sends the frames that still wait. Call once, at the end. Throws InputError if the rows were slower
    /// than the fastest source of the description, or if the bus could not carry all frames.
    void finish();

    /// Share of the time that the bus was busy; valid after `finish`.
    double load() const noexcept { return load_; }

  private:
    void offer(const std::vector<hal::Frame>& frames, std::int64_t ready_ns);
    std::int64_t jitter_ns();
    double mean_period_s() const;
    bool due(std::int64_t time_ns, std::int64_t period_ns, std::int64_t& next_ns) const;

    std::string source_;
    double bit_rate_;
    std::int64_t joint_period_ns_, output_period_ns_;
    bool efforts_; ///< the outputs are efforts of the joints
    DeviceFrames frames_;
    BusWire wire_;
    std::mt19937_64 engine_;
    double largest_jitter_ns_;
    double row_period_s_;
    std::int64_t next_joints_ns_, next_output_ns_, next_heartbeat_ns_;
    std::int64_t first_ns_ = 0, last_ns_ = 0;
    std::int64_t rows_ = 0;
    double load_ = 0;
};

/// Writes the traffic of a recording as a candump log and returns the load of the bus. `recording` must have
/// the outputs of the description; `options.row_period_s` is set here. Throws InputError like BusTraffic, and
/// if the recording has other joints; in that case no log is written.
double write_bus_log(const Recording& recording, const BusDescription& description,
                     const TrafficOptions& options, const std::filesystem::path& log);

} // namespace dfdyn::tools
