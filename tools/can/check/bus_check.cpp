// SPDX-License-Identifier: Apache-2.0
#include "tools/can/check/bus_check.hpp"

#include "tools/can/arm/bus_wire.hpp"
#include "tools/can/arm/device_frames.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace dfdyn::tools {

namespace {

std::span<const hal::Frame> span_of(const hal::FrameList& list) {
    return std::span(list.frame).first(static_cast<std::size_t>(list.count));
}

} // namespace

BusCheck::BusCheck(std::optional<BusDescription> description) : description_(std::move(description)) {
    if (description_) {
        describe();
    }
}

/// Sets the expected streams and joints from the description.
void BusCheck::describe() {
    arm_.emplace(*description_);
    boards_ = description_->boards;
    BusDescription joints = *description_;
    joints.sensor.reset(); // the sensor may be unable to send
    const DeviceFrames devices(joints);
    const std::vector<double> zeros(static_cast<std::size_t>(joints.joint_count));
    expect(devices.joints(zeros, zeros), description_->joints.rate_hz);
    if (const std::optional<hal::Frame> sync = devices.sync()) {
        expect({&*sync, 1}, description_->joints.rate_hz);
        sync_key_ = {sync->extended, sync->id};
    }
    if (description_->sensor) {
        const hal::FrameList frames = description_->sensor->encode({});
        expect(span_of(frames), description_->output.rate_hz);
        name_sender(span_of(frames), "sensor");
        for (const hal::Frame& frame : span_of(frames)) {
            streams_[{frame.extended, frame.id}].of_sensor = true;
        }
    }
    joints_.resize(zeros.size());
    restarts_.resize(zeros.size());
    position_keys_.resize(zeros.size());
    for (const BusBoard& board : description_->boards) {
        for (const int joint : board.joint) {
            if (joint != hal::unused_joint) {
                const hal::FrameList frames = board.board.encode({});
                const hal::Frame& position = frames.frame.front();
                name_sender(span_of(frames), "joint " + std::to_string(joint + 1));
                for (const hal::Frame& frame : span_of(frames)) {
                    streams_[{frame.extended, frame.id}].answers_sync = description_->synchronous;
                }
                position_keys_.at(static_cast<std::size_t>(joint)) = {position.extended, position.id};
                const auto index = static_cast<std::size_t>(joint);
                joints_.at(index) =
                    ValueWatch(board.board->encoder_turn_rad(), description_->joint_limits.at(index));
            }
        }
    }
}

/// Adds `name` to the senders of these frames; several names are separated by commas.
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
        stream.expected_bits += rate_hz * frame_bits(frame, description_->data_rate_ratio());
    }
}

bool BusCheck::claimed(const hal::Frame& frame) const {
    const auto concerns = [&](const BusBoard& board) { return board.board.concerns(frame); };
    return description_ && (std::ranges::any_of(boards_, concerns) ||
                            (description_->sensor && description_->sensor->concerns(frame)));
}

/// Returns true if the frame has an identifier of a device's values, but is a request of the host or an
/// answer without values.
bool BusCheck::is_request(const hal::Frame& frame) const {
    return description_ && ((description_->sensor && (*description_->sensor)->is_request(frame)) ||
                            std::ranges::any_of(boards_, [&](const BusBoard& board) {
                                return board.board->is_aside(frame);
                            }));
}

void BusCheck::update(hal::BusState state, const hal::BusCounters& counters) {
    state_ = state;
    worst_ = std::max(worst_, state);
    counters_ = counters;
    if (arm_) {
        arm_->update(state, counters);
    }
}

/// Advances the end of the observed time.
void BusCheck::pass(std::int64_t time_ns) {
    first_ns_ = started_ ? first_ns_ : time_ns;
    last_ns_ = started_ ? std::max(last_ns_, time_ns) : time_ns;
    started_ = true;
}

void BusCheck::take(const hal::Frame& frame) {
    if (frame.error) {
        return;
    }
    const std::uint64_t steps = clock_.steps();
    const std::span<const StreamClock::Timed> ready = clock_.take(frame);
    if (clock_.steps() != steps) {
        for (auto& [key, stream] : streams_) {
            stream.forget_phase();
        }
    }
    for (const StreamClock::Timed& timed : ready) {
        take(timed);
    }
}

void BusCheck::finish() {
    for (const StreamClock::Timed& timed : clock_.finish()) {
        take(timed);
    }
}

void BusCheck::take(const StreamClock::Timed& timed) {
    const hal::Frame& frame = timed.frame;
    const double bits = frame_bits(frame, description_ ? description_->data_rate_ratio() : 1);
    bits_ += bits;
    from_host_ += frame.origin == hal::Origin::this_host ? 1 : 0;
    BusStream* const stream = is_request(frame) ? nullptr : stream_of(frame);
    if (timed.stray) {
        if (stream != nullptr) {
            ++stream->strays;
        }
        return;
    }
    const bool overtaken = started_ && frame.stamp_ns < last_ns_;
    pass(frame.stamp_ns);
    watch_load(stream, bits);
    if (stream != nullptr) {
        stream->take(frame, bits, overtaken);
        watch_order(*stream, frame.stamp_ns);
        watch_answers(*stream, frame);
    }
    if (!arm_) {
        return;
    }
    const std::uint64_t rejected = arm_->bus().rejected.count();
    arm_->take(frame, last_ns_);
    if (stream != nullptr && !stream->other_form && arm_->bus().rejected.count() != rejected) {
        ++stream->rejected;
    }
    watch_joints(frame);
    assemble(last_ns_);
}

/// Finds the busiest windows of time. Each one begins in the middle of the one before.
void BusCheck::watch_load(const BusStream* stream, double bits) {
    constexpr std::int64_t half_ns = 100'000'000;
    const std::int64_t half = (last_ns_ - first_ns_) / half_ns;
    if (half != half_) {
        half_before_ = half == half_ + 1 ? half_bits_ : Load{};
        half_bits_ = {};
        half_ = half;
    }
    half_bits_.load += bits;
    half_bits_.unknown += stream != nullptr && !stream->known ? bits : 0;
    const double possible_bits = 2 * bit_rate() * seconds_of(half_ns);
    if (possible_bits > 0) {
        peak_.load = std::max(peak_.load, (half_before_.load + half_bits_.load) / possible_bits);
        peak_.unknown = std::max(peak_.unknown, (half_before_.unknown + half_bits_.unknown) / possible_bits);
    }
}

void BusCheck::watch_order(const BusStream& stream, std::int64_t stamp_ns) {
    constexpr std::int64_t once_ns = 10'000'000; // one step of the clock affects all sources within this time
    if (!stream.in_sequence()) {
        return;
    }
    if (stamp_ns < in_sequence_ns_ && stamp_ns - overtaken_ns_ > once_ns) {
        ++overtaken_;
        overtaken_ns_ = stamp_ns;
    }
    in_sequence_ns_ = std::max(in_sequence_ns_, stamp_ns);
}

void BusCheck::watch_answers(BusStream& stream, const hal::Frame& frame) {
    if (sync_key_ && *sync_key_ == BusStreamKey{frame.extended, frame.id}) {
        sync_ns_ = frame.stamp_ns;
    } else if (stream.answers_sync && sync_ns_ != 0 && stream.expected_hz > 0) {
        stream.answers.take(frame.stamp_ns - sync_ns_, 1e9 / stream.expected_hz);
    }
}

std::int64_t BusCheck::small_clock_step_ns() const {
    constexpr double same_step = 0.2; // share of the period
    std::vector<const BusStream*> regular;
    std::set<std::string> senders;
    for (const auto& [key, stream] : streams_) {
        if (stream.expected_hz > 0 && !stream.several && stream.is_regular()) {
            regular.push_back(&stream);
            senders.insert(stream.sender);
        }
    }
    if (senders.size() < 2) {
        return 0;
    }
    std::int64_t largest_ns = 0;
    for (const PhaseStep& step : regular.front()->phase_steps()) {
        const bool all = std::ranges::all_of(regular, [&](const BusStream* stream) {
            const double period_ns = 1e9 / stream->expected_hz;
            return std::ranges::any_of(stream->phase_steps(), [&](const PhaseStep& other) {
                const double apart_ns = std::abs(seconds_of(other.time_ns - step.time_ns)) * 1e9;
                const double off_ns = std::remainder(other.step_ns - step.step_ns, period_ns);
                return apart_ns < 3 * period_ns && std::abs(off_ns) < same_step * period_ns;
            });
        });
        if (all && std::abs(step.step_ns) > std::abs(static_cast<double>(largest_ns))) {
            largest_ns = std::llround(step.step_ns);
        }
    }
    return largest_ns;
}

void BusCheck::watch_joints(const hal::Frame& frame) {
    for (BusBoard& board : boards_) {
        const hal::Decoded decoded = board.board.decode(frame);
        if (decoded.kind == hal::Decoded::Kind::status && decoded.reason == hal::Reason::device_restarted) {
            ++restarts_.at(static_cast<std::size_t>(std::max(board.joint[0], 0)));
        }
        for (int i = 0; i < decoded.joints; ++i) {
            const hal::JointValue& value = decoded.joint.at(static_cast<std::size_t>(i));
            if (value.joint >= 0 && value.joint < static_cast<int>(joints_.size())) {
                joints_[static_cast<std::size_t>(value.joint)].take(value);
            }
        }
    }
}

/// Returns the stream of the frame's identifier; null if there is no room for another stream.
BusStream* BusCheck::stream_of(const hal::Frame& frame) {
    const BusStreamKey key{frame.extended, frame.id};
    const auto found = streams_.find(key);
    const auto other = streams_.find({!frame.extended, frame.id});
    const bool is_other_form = other != streams_.end() && other->second.is_described() &&
                               (found == streams_.end() || !found->second.is_described());
    if (is_other_form) {
        other->second.take_other_form();
    }
    if (found != streams_.end() && found->second.count > 0) {
        return &found->second;
    }
    if (found == streams_.end() && streams_.size() >= most_streams) {
        return nullptr;
    }
    BusStream& stream = streams_[key];
    // of another format than described, while the described source is silent
    stream.known = stream.known || (is_other_form ? other->second.count == 0 : claimed(frame));
    stream.other_form = is_other_form;
    stream.infers = !description_;
    return &stream;
}

/// Assembles the samples that are due at the sample rate, and counts their reasons.
void BusCheck::assemble(std::int64_t now_ns) {
    if (now_ns < next_sample_ns_) {
        return;
    }
    next_sample_ns_ = now_ns + description_->sample_period_ns();
    const BusSample sample = arm_->assemble(now_ns, now_ns);
    ++samples_;
    last_position_ = sample.report.position;
    last_output_ = sample.report.output;
    ++refused_.at(static_cast<std::size_t>(last_position_));
    if (last_output_ != last_position_) {
        ++refused_.at(static_cast<std::size_t>(last_output_));
    }
}

const BusStreams::value_type* BusCheck::position_stream(std::size_t joint) const {
    const auto found = streams_.find(position_keys_.at(joint));
    return found == streams_.end() ? nullptr : &*found;
}

std::uint64_t BusCheck::device_losses() const noexcept {
    const std::uint64_t own = counters_.dropped + counters_.controller_overruns;
    const std::uint64_t all = arm_ ? arm_->bus().health.losses() : 0;
    return all > own ? all - own : 0;
}

std::uint64_t BusCheck::refused(hal::Reason reason) const {
    return refused_.at(static_cast<std::size_t>(reason));
}

bool BusCheck::still(hal::Reason reason) const {
    return samples_ > 0 && (last_position_ == reason || last_output_ == reason);
}

double BusCheck::age_s(const BusStream& stream) const { return seconds_of(last_ns_ - stream.last_ns); }

bool BusCheck::dropped_all_missing() const {
    std::uint64_t missing = 0;
    for (const auto& [key, stream] : streams_) {
        missing += stream.missing();
    }
    const std::uint64_t dropped = counters_.dropped + counters_.controller_overruns;
    return dropped > 0 && 2 * missing <= 3 * dropped; // up to 50 % more may be missing by chance
}

double BusCheck::duration_s() const { return seconds_of(last_ns_ - first_ns_); }

double BusCheck::load() const {
    return duration_s() > 0 && bit_rate() > 0 ? bits_ / duration_s() / bit_rate() : 0;
}

double BusCheck::expected_load() const {
    double bits_per_s = 0;
    for (const auto& [key, stream] : streams_) {
        bits_per_s += stream.expected_bits;
    }
    return bit_rate() > 0 ? bits_per_s / bit_rate() : 0;
}

} // namespace dfdyn::tools
