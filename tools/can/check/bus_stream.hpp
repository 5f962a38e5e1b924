// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"
#include "dfdyn/hal/gate/backlog.hpp"
#include "dfdyn/hal/motion/encoder_reading.hpp"
#include "tools/can/check/sequence_watch.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

using hal::seconds_of;

/// Statistics of the frames with one identifier: their number, regularity, and missing frames of a regular
/// sequence.
///
/// Missing frames are counted by the phase of the sequence, which a phase-locked loop follows. An early frame
/// after a late one is therefore not a loss, and a sender whose clock deviates by 1 % loses nothing. With
/// `infers` the period is taken from the first frames if they are regular and come without bursts.
class BusStream {
  public:
    std::uint64_t count = 0;
    std::int64_t first_ns = 0, last_ns = 0;
    std::int64_t longest_gap_ns = 0;
    std::uint64_t rejected = 0; ///< frames rejected by the device's decoder
    /// frames whose time stamp is not later than that of the previous frame
    std::uint64_t not_increasing = 0;
    std::uint64_t copies = 0;    ///< frames with the content of the one before, less than a period after it
    std::uint64_t strays = 0;    ///< frames with a meaningless time stamp, which were not taken
    std::uint64_t overtaken = 0; ///< frames read after one of any source with a later time stamp
    double bits = 0;             ///< bits of all frames, with worst-case bit stuffing
    int length = 0;              ///< bytes of the last frame, or of the expected one
    bool known = false;          ///< the description names its sender
    std::string sender;          ///< such as `joint 2`; empty if unknown
    double expected_hz = 0;      ///< 0: not sent regularly, or unknown
    bool infers = false;         ///< `expected_hz` is inferred from the first frames
    double expected_bits = 0;    ///< bits per second
    bool several = false;        ///< more than one frame per period
    bool of_sensor = false;
    bool other_form = false;   ///< its format, 11 or 29 bits, differs from that of the described source
    bool answers_sync = false; ///< its device measures at a SYNC

    /// Takes the next frame. `frame_bits`: its worst-case length on the wire. `is_overtaken`: a frame with a
    /// later time stamp was read before it.
    void take(const hal::Frame& frame, double frame_bits, bool is_overtaken = false);

    /// Forgets the phase of the sequence: the clock was set.
    void forget_phase() noexcept;

    double rate_hz() const;  ///< 0 if there are fewer than two frames
    double jitter_s() const; ///< standard deviation of the intervals; 0 if there are fewer than three frames

    /// Number of frames that a regular sender sent but nobody received, except in gaps of more than
    /// `gap_periods`.
    std::uint64_t missing() const;
    double missing_share() const; ///< share of all sent frames
    /// Number of frames that came in addition to the sequence.
    std::uint64_t additional() const;
    /// Largest number of them among about fifty frames.
    double additional_at_once() const noexcept { return largest_recent_; }
    /// Number of frames that came more than 40 % of a period off the sequence, without overtaken ones.
    std::uint64_t off_sequence() const noexcept { return off_sequence_; }
    /// True if the last frame came at its place in the sequence.
    bool in_sequence() const noexcept { return in_sequence_; }
    /// Lasting changes of the sequence's phase.
    const std::vector<PhaseStep>& phase_steps() const noexcept { return phase_.steps(); }
    /// Takes a frame with the same number in the other form of identifiers, 11 or 29 bits.
    void take_other_form() noexcept { ++other_forms_, ++waiting_forms_; }
    /// Number of such frames, if most of them came where frames of the source were missing. Otherwise they
    /// belong to another device.
    std::uint64_t other_forms() const noexcept;
    /// Returns true if the description contains the rate of its frames.
    bool is_described() const noexcept { return known && expected_hz > 0; }
    SyncAnswers answers; ///< if its frames answer a SYNC
    /// Returns true if the sender keeps the expected period: at least half of the intervals are close to it,
    /// and their mean deviates by at most 5 %.
    bool is_regular() const;
    static constexpr double gap_periods = 10;

  private:
    void take_interval(std::int64_t interval_ns, bool is_overtaken);
    void infer_period();
    void follow_phase(std::int64_t stamp_ns, std::int64_t interval_ns, bool is_overtaken);
    /// Returns true if the frame waited while nobody read the bus. It is not missing, and not additional.
    bool waited(std::int64_t stamp_ns, double period_ns);

    double interval_square_sum_s2_ = 0;
    /// intervals until the period is inferred; at most a few
    std::vector<std::int64_t> first_intervals_;
    double next_ns_ = 0;       ///< expected time of the next frame in the sequence, relative to `last_ns`
    std::int64_t missing_ = 0; ///< minus the frames that arrived in addition to the sequence
    bool skipped_ = false;     ///< the last frame skipped a place in the sequence
    std::optional<hal::BacklogGate> backlog_;
    double recent_additional_ = 0, largest_recent_ = 0;
    bool in_sequence_ = false;
    std::uint64_t off_sequence_ = 0;
    PhaseSteps phase_;
    hal::Frame last_frame_{};
    /// intervals evaluated, and those close to the period
    std::uint64_t followed_ = 0, regular_ = 0;
    /// frames of the other form: all, those in place of missing frames, and those since the last frame
    std::uint64_t other_forms_ = 0, replacing_forms_ = 0, waiting_forms_ = 0;
    bool phase_known_ = false;
    double regular_periods_ = 0; ///< sum of the regular intervals in periods
};

/// Extended flag and identifier.
using BusStreamKey = std::pair<bool, std::uint32_t>;
using BusStreams = std::map<BusStreamKey, BusStream>;
std::string id_text(const BusStreamKey& key);

/// Returns the largest clock step (ns) below the sources' periods: all regular sources changed their phase by
/// it at the same time. 0: none.
std::int64_t common_phase_step_ns(const BusStreams& streams);

} // namespace dfdyn::tools
