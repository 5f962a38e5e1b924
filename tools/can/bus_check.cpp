// SPDX-License-Identifier: Apache-2.0
#include "tools/can/bus_check.hpp"

#include "tools/can/bus_wire.hpp"
#include "tools/can/device_frames.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

double seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

std::span<const hal::Frame> span_of(const hal::FrameList& list) {
    return std::span(list.frame).first(static_cast<std::size_t>(list.count));
}

} // namespace

double BusStream::rate_hz() const {
    return count > 1 && last_ns > first_ns ? static_cast<double>(count - 1) / seconds(last_ns - first_ns) : 0;
}

double BusStream::jitter_s() const {
    if (count < 3 || last_ns == first_ns) {
        return 0;
    }
    const double mean_s = 1 / rate_hz();
    return std::sqrt(
        std::max(0.0, interval_square_sum_s2 / static_cast<double>(count - 1) - mean_s * mean_s));
}

BusCheck::BusCheck(BusDescription description)
    : description_(std::move(description)), arm_(make_bus_arm(description_)) {
    BusDescription joints = description_;
    joints.sensor.reset(); // which need not be able to send
    const DeviceFrames devices(joints);
    const std::vector<double> zeros(static_cast<std::size_t>(joints.joint_count));
    expect(devices.joints(zeros, zeros), description_.joints.rate_hz);
    if (const std::optional<hal::Frame> sync = devices.sync()) {
        expect({&*sync, 1}, description_.joints.rate_hz);
    }
    if (description_.sensor) {
        const hal::FrameList frames = description_.sensor->encode({});
        expect(span_of(frames), description_.output.rate_hz);
        name_sender(span_of(frames), "sensor");
    }
    for (const BusBoard& board : description_.boards) {
        for (const int joint : board.joint) {
            if (joint != hal::unused_joint) {
                name_sender(span_of(board.board.encode({})), "joint " + std::to_string(joint + 1));
            }
        }
    }
}

/// One after the other where there are several.
void BusCheck::name_sender(std::span<const hal::Frame> frames, const std::string& name) {
    for (const hal::Frame& frame : frames) {
        std::string& sender = streams_[{frame.extended, frame.id}].sender;
        sender += (sender.empty() ? "" : ", ") + name;
    }
}

void BusCheck::expect(std::span<const hal::Frame> frames, double rate_hz) {
    for (const hal::Frame& frame : frames) {
        BusStream& stream = streams_[{frame.extended, frame.id}];
        stream.several = stream.known; // variants of one message
        stream.known = true;
        stream.length = frame.length;
        stream.expected_hz += rate_hz;
        stream.expected_bits += rate_hz * frame_bits(frame);
    }
}

bool BusCheck::claimed(const hal::Frame& frame) const {
    const auto claims = [&](const BusBoard& board) { return board.board.claims(frame.id); };
    return !frame.extended && (std::ranges::any_of(description_.boards, claims) ||
                               (description_.sensor && description_.sensor->claims(frame.id)));
}

/// Of the host, on the identifier on which the sensor answers.
bool BusCheck::is_request(const hal::Frame& frame) const {
    const auto* ati =
        description_.sensor ? std::get_if<hal::AtiNetcan>(&description_.sensor->device()) : nullptr;
    return ati != nullptr && hal::has_id(frame, ati->poll().id) && frame.length == 0;
}

void BusCheck::update(hal::BusState state, const hal::BusCounters& counters, std::int64_t now_ns) {
    first_ns_ = started_ ? first_ns_ : now_ns;
    last_ns_ = now_ns;
    started_ = true;
    state_ = state;
    worst_ = std::max(worst_, state);
    counters_ = counters;
    arm_->update(state, counters);
}

void BusCheck::take(const hal::Frame& frame, std::int64_t now_ns) {
    if (frame.error) {
        return;
    }
    bits_ += frame_bits(frame);
    const std::uint64_t rejected = arm_->bus().rejected.count();
    arm_->take(frame, now_ns);
    if (!is_request(frame)) {
        count(frame, arm_->bus().rejected.count() != rejected);
    }
    assemble(now_ns);
}

void BusCheck::count(const hal::Frame& frame, bool rejected) {
    const BusStreamKey key{frame.extended, frame.id};
    if (streams_.size() >= most_streams && !streams_.contains(key)) {
        return;
    }
    BusStream& stream = streams_[key];
    if (stream.count == 0) {
        stream.known = stream.known || claimed(frame);
        stream.first_ns = stream.last_ns = frame.stamp_ns;
    }
    const std::int64_t interval_ns = frame.stamp_ns - stream.last_ns;
    stream.not_increasing += stream.count > 0 && interval_ns <= 0 ? 1 : 0;
    ++stream.count;
    stream.longest_gap_ns = std::max(stream.longest_gap_ns, interval_ns);
    stream.interval_square_sum_s2 += seconds(interval_ns) * seconds(interval_ns);
    stream.last_ns = std::max(stream.last_ns, frame.stamp_ns);
    stream.bits += frame_bits(frame);
    stream.length = frame.length;
    stream.rejected += rejected ? 1 : 0;
}

/// What the devices say of themselves, at the sample rate.
void BusCheck::assemble(std::int64_t now_ns) {
    if (now_ns < next_sample_ns_) {
        return;
    }
    next_sample_ns_ = now_ns + description_.sample_period_ns();
    const BusSample& sample = arm_->assemble(now_ns, now_ns);
    ++samples_;
    last_position_ = sample.position_reason;
    last_output_ = sample.output_reason;
    ++refused_.at(static_cast<std::size_t>(sample.position_reason));
    if (sample.output_reason != sample.position_reason) {
        ++refused_.at(static_cast<std::size_t>(sample.output_reason));
    }
}

std::uint64_t BusCheck::refused(hal::Reason reason) const {
    return refused_.at(static_cast<std::size_t>(reason));
}

bool BusCheck::still(hal::Reason reason) const {
    return samples_ > 0 && (last_position_ == reason || last_output_ == reason);
}

double BusCheck::age_s(const BusStream& stream) const { return seconds(last_ns_ - stream.last_ns); }

double BusCheck::duration_s() const { return seconds(last_ns_ - first_ns_); }

double BusCheck::load() const { return duration_s() > 0 ? bits_ / duration_s() / description_.bit_rate : 0; }

double BusCheck::expected_load() const {
    double bits_per_s = 0;
    for (const auto& [key, stream] : streams_) {
        bits_per_s += stream.expected_bits;
    }
    return bits_per_s / description_.bit_rate;
}

} // namespace dfdyn::tools
