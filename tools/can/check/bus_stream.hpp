// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace dfdyn::tools {

constexpr double seconds_of(std::int64_t ns) noexcept { return 1e-9 * static_cast<double>(ns); }

/// The frames of one identifier: how many, how steadily, and how many of a steady sequence are missing.
///
/// Missing frames are counted against the sequence's phase, which a phase-locked loop follows: an early frame
/// after a late one is no loss, nor is a sender whose clock differs by 1 %. With `infers` the period
/// is that of the first frames, if they come steadily.
class BusStream {
  public:
    std::uint64_t count = 0;
    std::int64_t first_ns = 0, last_ns = 0;
    std::int64_t longest_gap_ns = 0;
    std::uint64_t rejected = 0;       ///< by the device's decoder
    std::uint64_t not_increasing = 0; ///< frames with a stamp not after the one before
    double bits = 0;                  ///< of all, at worst
    int length = 0;                   ///< of the last frame, or of the one that is expected; bytes
    bool known = false;               ///< the description says who sends it
    std::string sender;               ///< such as `joint 2`; empty where that is not known
    double expected_hz = 0;           ///< 0: not sent steadily, or nobody knows
    bool infers = false;              ///< `expected_hz` becomes what the first frames show
    double expected_bits = 0;         ///< per second
    bool several = false;             ///< more than one frame per period

    /// Takes a frame of that stamp; `bits`: its length on the wire at worst.
    void take(const hal::Frame& frame, double frame_bits);

    double rate_hz() const;  ///< 0 for fewer than two frames
    double jitter_s() const; ///< standard deviation of the intervals; 0 for fewer than three frames

    /// Frames that a steady sender sent and nobody received, outside of gaps of more than `gap_periods`.
    std::uint64_t missing() const;
    double missing_share() const; ///< of all that were sent
    /// Whether the sender keeps the expected period: at least half of the intervals are close to it, and
    /// their mean is within 5 %.
    bool is_regular() const;
    static constexpr double gap_periods = 10;

  private:
    void take_interval(std::int64_t interval_ns);
    void infer_period();
    void follow_phase(std::int64_t stamp_ns, std::int64_t interval_ns);

    double interval_square_sum_s2_ = 0;
    std::vector<std::int64_t> first_intervals_; ///< until the period is inferred; at most a few
    double next_ns_ = 0;                        ///< the next frame of the sequence, after `last_ns`
    std::int64_t missing_ = 0;                  ///< less the frames that came beside the sequence
    std::uint64_t followed_ = 0, regular_ = 0;  ///< intervals
    double regular_periods_ = 0;                ///< sum of those
};

/// By extended, identifier.
using BusStreamKey = std::pair<bool, std::uint32_t>;
using BusStreams = std::map<BusStreamKey, BusStream>;
std::string id_text(const BusStreamKey& key);

} // namespace dfdyn::tools
