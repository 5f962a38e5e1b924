// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/arm/bus_wire.hpp"
#include "tools/can/arm/device_frames.hpp"

#include <filesystem>
#include <random>
#include <span>

namespace dfdyn::tools {

struct TrafficOptions {
    double jitter_us = 0; ///< joints' frames, and wrenches, are late by up to this, evenly distributed
    std::uint64_t seed = 1;
    /// Sample period of rows whose times have jitter: a source that sends less than 1.5 times as rarely sends
    /// with every row, a slower one with the row closest to its time. 0: the rows' times are exact.
    double row_period_s = 0;
};

/// What the devices of a bus description would have sent while an arm did what is told row by row: frames
/// with the devices' quantisation, one after the other as the bus has room. The same rows, description and
/// options give the same frames.
class BusTraffic {
  public:
    /// The devices come up, and tell what they are asked once, before the first row: stamps are the rows'
    /// times and this.
    static constexpr std::int64_t lead_ns = 10'000'000;

    /// Throws as DeviceFrames.
    BusTraffic(const BusDescription& description, const TrafficOptions& options, BusWire::OnFrame on_frame);

    /// The next row: positions (rad) and outputs (of the description's kind) at `time_ns`, later than the
    /// last. A source that is slower than the rows leaves some out.
    void add(std::int64_t time_ns, std::span<const double> position, std::span<const double> output);

    /// Sends what still waits; call once, last. Throws InputError where the rows came more slowly than the
    /// fastest source of the description sends, or where the bus could not carry it all.
    void finish();

    /// Share of the time that the bus was busy, after `finish`.
    double load() const noexcept { return load_; }

  private:
    void offer(const std::vector<hal::Frame>& frames, std::int64_t ready_ns);
    std::int64_t jitter_ns();
    double mean_period_s() const;
    bool due(std::int64_t time_ns, std::int64_t period_ns, std::int64_t& next_ns) const;

    std::string source_;
    double bit_rate_;
    std::int64_t joint_period_ns_, output_period_ns_;
    bool efforts_; ///< the outputs come from the joints
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

/// Writes the traffic of a recording as a candump log; returns the load of the bus. `recording` has the
/// outputs of the description; `options.row_period_s` is filled in. Throws InputError as BusTraffic, and
/// where the recording has other joints; then there is no log.
double write_bus_log(const Recording& recording, const BusDescription& description,
                     const TrafficOptions& options, const std::filesystem::path& log);

} // namespace dfdyn::tools
