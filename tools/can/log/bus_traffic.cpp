// SPDX-License-Identifier: Apache-2.0
#include "tools/can/log/bus_traffic.hpp"

#include "tools/base/recording/sample_grid.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/can/log/frame_recorder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace dfdyn::tools {

namespace {

constexpr std::int64_t long_ago_ns = std::numeric_limits<std::int64_t>::min();

std::int64_t period_ns(const BusSource& source) { return std::llround(1e9 / source.rate_hz); }

} // namespace

BusTraffic::BusTraffic(const BusDescription& description, const TrafficOptions& options,
                       BusWire::OnFrame on_frame)
    : source_(description.source), bit_rate_(description.bit_rate),
      joint_period_ns_(period_ns(description.joints)), output_period_ns_(period_ns(description.output)),
      efforts_(!description.sensor), frames_(description),
      wire_(description.bit_rate, std::move(on_frame), description.data_rate_ratio()), engine_(options.seed),
      largest_jitter_ns_(1e3 * options.jitter_us), row_period_s_(options.row_period_s),
      next_joints_ns_(long_ago_ns), next_output_ns_(long_ago_ns), next_heartbeat_ns_(long_ago_ns) {}

void BusTraffic::add(std::int64_t time_ns, std::span<const double> position, std::span<const double> output) {
    if (rows_ == 0) {
        first_ns_ = time_ns;
        offer(frames_.full_scales(), time_ns);
        offer(frames_.heartbeats(), time_ns);
        next_heartbeat_ns_ = time_ns + DeviceFrames::heartbeat_period_ns;
    }
    last_ns_ = time_ns;
    ++rows_;
    time_ns += lead_ns;
    wire_.send_before(time_ns);
    if (due(time_ns, DeviceFrames::heartbeat_period_ns, next_heartbeat_ns_)) {
        offer(frames_.heartbeats(), time_ns);
    }
    if (due(time_ns, joint_period_ns_, next_joints_ns_)) {
        if (const auto sync = frames_.sync()) {
            wire_.offer(*sync, time_ns);
            time_ns = wire_.send_all();
        }
        for (const hal::Frame& frame :
             frames_.joints(position, efforts_ ? output : std::span<const double>())) {
            wire_.offer(frame, time_ns + jitter_ns());
        }
    }
    if (due(time_ns, output_period_ns_, next_output_ns_)) {
        offer(frames_.wrench(output), time_ns + jitter_ns());
    }
}

void BusTraffic::finish() {
    wire_.send_all();
    const double fastest_hz = 1e9 / static_cast<double>(std::min(joint_period_ns_, output_period_ns_));
    const double rows_hz = 1 / (row_period_s_ > 0 ? row_period_s_ : mean_period_s());
    if (rows_hz < 0.99 * fastest_hz) {
        throw InputError(source_ + ": rate_hz: expected up to " + number_text(rows_hz) +
                         ", the mean rate of the rows, found " + number_text(fastest_hz));
    }
    load_ = wire_.bits() / (bit_rate_ * mean_period_s() * static_cast<double>(rows_));
    if (load_ > 1) {
        throw InputError(source_ + ": bit_rate: expected a bus that carries all frames, found a load of " +
                         percent(load_));
    }
}

/// Does not use std::uniform_real_distribution, which differs between standard libraries.
std::int64_t BusTraffic::jitter_ns() {
    return std::llround(largest_jitter_ns_ * std::ldexp(static_cast<double>(engine_() >> 11U), -53));
}

void BusTraffic::offer(const std::vector<hal::Frame>& frames, std::int64_t ready_ns) {
    for (const hal::Frame& frame : frames) {
        wire_.offer(frame, ready_ns);
    }
}

/// Returns true if a source with this period sends at the row of this time. `next_ns`: its next send time,
/// which is updated.
bool BusTraffic::due(std::int64_t time_ns, std::int64_t period_ns, std::int64_t& next_ns) const {
    const auto row_ns = static_cast<std::int64_t>(1e9 * row_period_s_);
    if (2 * period_ns <= 3 * row_ns) {
        return true;
    }
    const std::int64_t early_ns = std::max(row_ns / 2, period_ns / 100);
    if (next_ns != long_ago_ns && time_ns < next_ns - early_ns) {
        return false;
    }
    const bool late = next_ns == long_ago_ns || time_ns > next_ns + period_ns;
    next_ns = (late ? time_ns : next_ns) + period_ns;
    return true;
}

double BusTraffic::mean_period_s() const {
    return rows_ < 2 ? std::numeric_limits<double>::infinity()
                     : 1e-9 * static_cast<double>(last_ns_ - first_ns_) / static_cast<double>(rows_ - 1);
}

double write_bus_log(const Recording& recording, const BusDescription& description,
                     const TrafficOptions& options, const std::filesystem::path& log) {
    if (recording.joint_count() != static_cast<std::size_t>(description.joint_count)) {
        throw InputError(recording.source + ": expected positions of " +
                         std::to_string(description.joint_count) + " joints, as on the bus, found " +
                         std::to_string(recording.joint_count()));
    }
    if (recording.row_count() == 0 || recording.time_ns.front() < 0) {
        throw InputError(recording.source + ": expected rows from time 0 on, found none or earlier ones");
    }
    FrameRecorder recorder(log, "can0");
    TrafficOptions timed = options;
    timed.row_period_s = recording.row_count() > 1 ? sample_period_s({&recording, 1}) : 0;
    BusTraffic traffic(description, timed, [&](const hal::Frame& frame) { recorder.write(frame); });
    for (std::size_t row = 0; row < recording.row_count(); ++row) {
        traffic.add(recording.time_ns[row], recording.position.row(row), recording.output.row(row));
    }
    traffic.finish();
    recorder.commit();
    return traffic.load();
}

} // namespace dfdyn::tools
