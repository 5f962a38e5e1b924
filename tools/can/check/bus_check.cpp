// SPDX-License-Identifier: Apache-2.0
#include "tools/can/check/bus_check.hpp"

#include "tools/can/arm/bus_wire.hpp"
#include "tools/can/arm/device_frames.hpp"
#include "tools/can/families/family.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

std::span<const hal::Frame> span_of(const hal::FrameList& list) {
    return std::span(list.frame).first(static_cast<std::size_t>(list.count));
}

} // namespace

BusCheck::BusCheck(std::optional<BusDescription> description)
    : description_(std::move(description)), load_(description_ ? description_->bit_rate : 0) {
    if (description_) {
        describe();
        for (const auto& [key, stream] : streams_) {
            load_.expect(stream.expected_bits);
        }
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
    describe_joints();
}

void BusCheck::describe_joints() {
    for (std::size_t i = 0; i < boards_.size(); ++i) {
        const BusBoard& board = boards_[i];
        heartbeat_timeout_ns_ = std::max(heartbeat_timeout_ns_, board.board->heartbeat_timeout_ns());
        for (const int joint : board.joint) {
            if (joint != hal::unused_joint) {
                const hal::FrameList frames = board.board.encode({});
                const hal::Frame& position = frames.frame.front();
                name_sender(span_of(frames), "joint " + std::to_string(joint + 1));
                for (const hal::Frame& frame : span_of(frames)) {
                    streams_[{frame.extended, frame.id}].answers_sync = description_->synchronous;
                }
                const auto index = static_cast<std::size_t>(joint);
                CheckedJoint& checked = joints_.at(index);
                checked.position_key = {position.extended, position.id};
                checked.board = i;
                checked.values =
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
bool BusCheck::carries_no_values(const hal::Frame& frame) const {
    return description_ && ((description_->sensor && (*description_->sensor)->carries_no_values(frame)) ||
                            std::ranges::any_of(boards_, [&](const BusBoard& board) {
                                return board.board->carries_no_values(frame);
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
    load_.count(bits);
    from_host_ += frame.origin == hal::Origin::this_host ? 1 : 0;
    BusStream* const stream = carries_no_values(frame) ? nullptr : stream_of(frame);
    if (timed.stray) {
        if (stream != nullptr) {
            ++stream->strays;
        }
        return;
    }
    const bool overtaken = started_ && frame.stamp_ns < last_ns_;
    pass(frame.stamp_ns);
    load_.watch(last_ns_ - first_ns_, bits, stream == nullptr || stream->known);
    if (stream != nullptr) {
        stream->take(frame, bits, overtaken);
        if (stream->in_sequence()) {
            order_.take(frame.stamp_ns);
        }
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

void BusCheck::watch_answers(BusStream& stream, const hal::Frame& frame) {
    if (sync_key_ && *sync_key_ == BusStreamKey{frame.extended, frame.id}) {
        sync_ns_ = frame.stamp_ns;
    } else if (stream.answers_sync && sync_ns_ != 0 && stream.expected_hz > 0) {
        stream.answers.take(frame.stamp_ns - sync_ns_, 1e9 / stream.expected_hz);
    }
}

void BusCheck::watch_joints(const hal::Frame& frame) {
    for (BusBoard& board : boards_) {
        const hal::Decoded decoded = board.board.decode(frame);
        if (decoded.kind == hal::Decoded::Kind::status && decoded.reason == hal::Reason::device_restarted) {
            ++joints_.at(static_cast<std::size_t>(std::max(board.joint[0], 0))).restarts;
        }
        for (int i = 0; i < decoded.joints; ++i) {
            const hal::JointValue& value = decoded.joint.at(static_cast<std::size_t>(i));
            if (value.joint >= 0 && value.joint < static_cast<int>(joints_.size())) {
                CheckedJoint& joint = joints_[static_cast<std::size_t>(value.joint)];
                joint.values.take(value);
                joint.first_ns = joint.frames == 0 ? frame.stamp_ns : joint.first_ns;
                ++joint.frames;
                joint.last_ns = std::max(joint.last_ns, frame.stamp_ns);
            }
        }
    }
}

/// Returns the identifier under which the frame is counted. All boards are of one family.
BusStreamKey BusCheck::key_of(const hal::Frame& frame) const {
    const BusStreamKey own{frame.extended, frame.id};
    const auto stream_id = description_ ? description_->joint_family->stream_id : nullptr;
    return stream_id == nullptr || streams_.contains(own) ? own
                                                          : BusStreamKey{frame.extended, stream_id(frame)};
}

/// Returns the stream of the frame's identifier; null if there is no room for another stream.
BusStream* BusCheck::stream_of(const hal::Frame& frame) {
    const BusStreamKey key = key_of(frame);
    const auto found = streams_.find(key);
    const auto other = streams_.find({!key.first, key.second});
    const bool is_other_form = other != streams_.end() && other->second.is_described() &&
                               (found == streams_.end() || !found->second.is_described());
    if (is_other_form && claimed(frame)) {
        return &other->second; // the device sends both forms
    }
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
    const bool early = now_ns - first_ns_ <= heartbeat_timeout_ns_; // the first heartbeat may not be due yet
    const auto without_early_heartbeat = [early](hal::Reason reason) {
        return early && reason == hal::Reason::heartbeat_missing ? hal::Reason::waiting_for_position : reason;
    };
    samples_.add(without_early_heartbeat(sample.report.position),
                 without_early_heartbeat(sample.report.output));
}

const BusStreams::value_type* BusCheck::position_stream(std::size_t joint) const {
    const auto found = streams_.find(joints_.at(joint).position_key);
    return found == streams_.end() ? nullptr : &*found;
}

bool BusCheck::lacks_values(std::size_t joint) const {
    constexpr double longest_silence = 10;        // periods of the fastest board, and own mean intervals
    constexpr std::uint64_t to_know_its_rate = 5; // frames
    const CheckedJoint& checked = joints_.at(joint);
    const BusStreams::value_type* const source = position_stream(joint);
    const bool shares = std::ranges::any_of(joints_, [&](const CheckedJoint& other) {
        return other.board != checked.board && other.position_key == checked.position_key;
    });
    if (!shares || source == nullptr || source->second.count == 0) {
        return false;
    }
    const BusStream& stream = source->second;
    const std::int64_t heard_ns = checked.frames > 0 ? checked.last_ns : stream.first_ns;
    double interval_s = 1 / description_->joints.rate_hz;
    if (checked.frames >= to_know_its_rate) {
        const double own_s =
            seconds_of(checked.last_ns - checked.first_ns) / static_cast<double>(checked.frames - 1);
        interval_s = std::max(interval_s, own_s);
    }
    return seconds_of(stream.last_ns - heard_ns) > longest_silence * interval_s;
}

bool BusCheck::lacks_a_sender(const BusStreamKey& key) const {
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
        if (joints_[joint].position_key == key && lacks_values(joint)) {
            return true;
        }
    }
    return false;
}

std::uint64_t BusCheck::device_losses() const noexcept {
    const std::uint64_t own = counters_.dropped + counters_.controller_overruns;
    const std::uint64_t all = arm_ ? arm_->bus().health.losses() : 0;
    return all > own ? all - own : 0;
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

} // namespace dfdyn::tools
