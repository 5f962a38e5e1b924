// SPDX-License-Identifier: Apache-2.0
// Rules for faults of one source on a bus, one rule each, with the remedy for the user.
#include "tools/base/text/number.hpp"
#include "tools/can/check/bus_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr double least_rate = 0.9;     ///< share of the expected rate
constexpr double largest_rate = 1.02;  ///< ratio to the expected rate; the clock of a device is more accurate
constexpr double rate_of_two = 1.5;    ///< ratio to the expected rate
constexpr double largest_gap = 3;      ///< periods
constexpr double largest_jitter = 0.4; ///< share of the period
constexpr double silent_periods = 10;  ///< periods before the end
constexpr double silent_s = 0.5;       ///< before the end, for a source that nobody described
constexpr double enough_frames = 20;
/// share of the period: typical jitter of two senders with one identifier
constexpr double jitter_of_two = 0.25;
constexpr double least_missing = 0.0005; ///< share of the frames; smaller losses are not reported
constexpr std::uint64_t least_missing_frames = 3;
constexpr std::uint64_t least_overtaken = 3; ///< with fewer frames, pauses are judged as usual
constexpr double largest_load_in_time = 0.6; ///< above it, frames wait for others
constexpr double least_at_once = 12;         ///< additional frames
constexpr double least_copies = 0.5;         ///< share of the additional frames

struct Source {
    const BusStreamKey& key;
    const BusStream& stream;
    const BusCheck& check;

    double ratio() const { return stream.rate_hz() / stream.expected_hz; }
    /// Returns the ratio without copies of the frame before.
    double ratio_without_copies() const {
        return ratio() * (1 - static_cast<double>(stream.copies) / static_cast<double>(stream.count));
    }
    double periods(double time_s) const { return time_s * stream.expected_hz; }
    /// Returns the ratio without the longest pause.
    double ratio_without_gap() const {
        const auto all_ns = static_cast<double>(stream.last_ns - stream.first_ns);
        const double rest_ns = all_ns - static_cast<double>(stream.longest_gap_ns);
        return rest_ns > 0 ? ratio() * all_ns / rest_ns : ratio();
    }
    /// Frames with a wrong stamp are out of sequence, but not a silence.
    double largest_gap_with_strays() const {
        return std::min(largest_gap + static_cast<double>(stream.strays), BusStream::gap_periods);
    }
    double gap_periods() const { return periods(seconds_of(stream.longest_gap_ns)); }
    double jitter_periods() const { return periods(stream.jitter_s()); }
    bool silent() const { return stream.expected_hz > 0 && stream.count == 0; }
    bool stopped() const {
        const double age_s = check.age_s(stream);
        return stream.expected_hz > 0 && stream.count > 0 && periods(age_s) > silent_periods &&
               (!stream.infers || age_s > silent_s);
    }
    /// Returns true if the source is active and has sent enough frames to be judged.
    bool runs() const {
        return stream.expected_hz > 0 && static_cast<double>(stream.count) > enough_frames && !stopped() &&
               !check.lacks_a_sender(key);
    }
    bool is_described() const { return runs() && !stream.infers; }
    /// Returns true if the number of frames is not an exception.
    bool many(std::uint64_t frames) const {
        return frames >= least_missing_frames &&
               static_cast<double>(frames) >= least_missing * static_cast<double>(stream.count);
    }
    /// Returns true if there are more frames than a regular sequence has.
    bool has_more() const { return is_described() && many(stream.additional()); }
    bool duplicated() const {
        return has_more() &&
               static_cast<double>(stream.copies) >= least_copies * static_cast<double>(stream.additional());
    }
    bool collides() const {
        return !duplicated() &&
               ((has_more() && stream.additional_at_once() > least_at_once) ||
                (is_described() && (ratio() > rate_of_two || (ratio_without_copies() > largest_rate &&
                                                              jitter_periods() > jitter_of_two))));
    }
    bool jitters() const {
        return keeps_rate() && !stream.several && !collides() && !duplicated() && !loses() && !has_gaps() &&
               jitter_periods() > largest_jitter;
    }
    bool answers_late() const { return is_described() && many(stream.answers.late()); }
    bool is_late() const {
        return !answers_late() && check.load().expected() <= largest_load_in_time &&
               common_phase_step_ns(check.streams()) == 0 && is_described() && keeps_rate() &&
               !stream.several && stream.is_regular() && !collides() && !duplicated() && !jitters() &&
               many(stream.off_sequence());
    }
    /// With several messages on one identifier, one pause loses twice as many. Frames with a wrong stamp are
    /// not lost.
    std::uint64_t enough_missing() const {
        return (stream.several ? 2 : 1) * least_missing_frames + stream.strays;
    }
    /// Returns true if frames of a sender that keeps its period are missing. Frames dropped by this computer
    /// are excluded because they are reported elsewhere.
    bool loses() const {
        return runs() && !collides() && !check.dropped_all_missing() &&
               stream.missing() >= enough_missing() && stream.missing_share() >= least_missing &&
               (stream.several || stream.is_regular());
    }
    bool slow() const { return is_described() && ratio() < least_rate && !loses() && !has_gaps(); }
    /// Returns true if there is a pause that scattered losses do not explain.
    bool has_gaps() const {
        const bool steady = stream.several ? ratio_without_gap() >= least_rate : stream.is_regular();
        const bool long_ones = loses() || stream.several || stream.overtaken >= least_overtaken;
        return runs() && !collides() && steady &&
               gap_periods() > (long_ones ? BusStream::gap_periods : largest_gap_with_strays());
    }
    bool keeps_rate() const { return runs() && ratio() >= least_rate && ratio() <= largest_rate; }
};

std::string rates(const Source& source) {
    return formatted("%.4g frames/s", source.stream.rate_hz()) +
           formatted(", described %.4g", source.stream.expected_hz);
}

/// Returns an undescribed identifier with the properties of a silent described source; null if there is none.
const BusStreams::value_type* impostor(const Source& source) {
    for (const auto& other : source.check.streams()) {
        const BusStream& stream = other.second;
        const bool alike = !stream.known && stream.length == source.stream.length &&
                           std::abs(stream.rate_hz() / source.stream.expected_hz - 1) < 1 - least_rate;
        if (alike && other.first.first == source.key.first) {
            return &other;
        }
    }
    return nullptr;
}

struct Rule {
    const char* name;
    const char* what;
    bool (*broken)(const Source&);
    std::string (*evidence)(const Source&);
    const char* confirm; ///< ID is the placeholder of the identifier
    const char* fix;
};

constexpr std::array<Rule, 13> rules{{
    {"wrong_identifier", "is not sent, but a similar source on another identifier",
     [](const Source& s) { return s.silent() && impostor(s) != nullptr; },
     [](const Source& s) {
         const auto& [key, stream] = *impostor(s);
         return id_text(key) + formatted(", not described, sends %.4g frames/s", stream.rate_hz()) + " of " +
                std::to_string(stream.length) + " bytes, the expected properties of this one";
     },
     "move the joint, or load the sensor, by hand: the bytes of those frames change (candump -c IFACE)",
     "Correct the address in the description, or in the device."},
    {"silent_source", "is never sent",
     [](const Source& s) { return s.silent() && s.stream.other_forms() == 0 && impostor(s) == nullptr; },
     [](const Source& s) { return formatted("no frame in %.3g s", s.check.duration_s()); },
     "candump -n 1 IFACE,ID:MASK waits for one frame of it",
     "Check the device's power and cable. Start its transmission. Check its address in the description."},
    {"source_stopped", "is no longer sent", [](const Source& s) { return s.stopped(); },
     [](const Source& s) {
         return formatted("last frame %.3g s before the end", s.check.age_s(s.stream)) +
                formatted(", %.4g frames/s before", s.stream.rate_hz());
     },
     "candump -n 1 IFACE,ID:MASK waits for one frame of it",
     "Check the device's power and cable: a missing node causes no bus error."},
    {"id_collision", "is sent too often: two devices may share the identifier",
     [](const Source& s) { return s.collides(); }, rates,
     "unplug the device: remaining frames come from another one",
     "Give one of the two another identifier, or correct rate_hz in the description."},
    {"duplicated_frames", "is sometimes received twice", [](const Source& s) { return s.duplicated(); },
     [](const Source& s) {
         return std::to_string(s.stream.additional()) + " frames more than the sequence has; " +
                std::to_string(s.stream.copies) + " repeat the one before";
     },
     "connect a second computer to the bus: if it receives them once, this one's adapter or gateway repeats "
     "them",
     "Check the routing of gateway and adapter: no frame may come back to its bus."},
    {"fast_source", "is sent more often than described",
     [](const Source& s) {
         return s.is_described() && s.ratio() > largest_rate && !s.collides() && !s.duplicated();
     },
     rates, "read the period from the device", "Correct rate_hz in the description, or the device's period."},
    {"slow_source", "is sent too rarely", [](const Source& s) { return s.slow(); },
     [](const Source& s) {
         return rates(s) +
                formatted("; longest pause %.3g ms", 1e-6 * static_cast<double>(s.stream.longest_gap_ns));
     },
     "candump -t d IFACE,ID:MASK: even intervals mean a slow device",
     "Set the device's period, or rate_hz in the description."},
    {"lost_frames", "loses frames", [](const Source& s) { return s.loses(); },
     [](const Source& s) {
         return percent(s.stream.missing_share()) + ": " + std::to_string(s.stream.missing()) + " of " +
                std::to_string(s.stream.missing() + s.stream.count) +
                " frames are missing in a sequence of " + formatted("%.4g frames/s", s.stream.expected_hz);
     },
     "connect a second computer to the bus: if it receives the frames, this one loses them",
     "Lower the load of the bus. Read at a real-time priority. Check cable, connectors and the device's own "
     "errors."},
    {"gaps", "has gaps", [](const Source& s) { return s.has_gaps(); },
     [](const Source& s) {
         return formatted("%.3g ms without a frame", 1e-6 * static_cast<double>(s.stream.longest_gap_ns)) +
                formatted(", expected every %.3g ms", 1e3 / s.stream.expected_hz);
     },
     "ip -details -statistics link show IFACE: dropped and overrun frames are this computer's losses",
     "Read at a real-time priority. Lower the load of the bus. Look for a loose cable or a device that "
     "restarts."},
    {"jitter", "has irregular intervals", [](const Source& s) { return s.jitters(); },
     [](const Source& s) {
         return formatted("standard deviation of the intervals %.3g ms", 1e3 * s.stream.jitter_s()) +
                formatted(", period %.3g ms", 1e3 / s.stream.expected_hz);
     },
     "record on another computer: if it is regular there, this one's stamps are late",
     "Give the source a lower identifier. Lower the load of the bus. Use drives that measure at SYNC, or "
     "trigger on timer."},
    {"late_frames", "has late frames", [](const Source& s) { return s.is_late(); },
     [](const Source& s) {
         return std::to_string(s.stream.off_sequence()) + " of " + std::to_string(s.stream.count) +
                formatted(" frames are more than 40 %% of %.3g ms off", 1e3 / s.stream.expected_hz);
     },
     "record on another computer: if the frames are in time there, this one's stamps are late",
     "Lower the load of the bus. Give the source a lower identifier. Check that no gateway or program delays "
     "its frames."},
    {"late_answers", "answers a SYNC at unusual times, perhaps after the next one",
     [](const Source& s) { return s.answers_late(); },
     [](const Source& s) {
         return std::to_string(s.stream.answers.late()) + " of " + std::to_string(s.stream.count) +
                formatted(" answers are more than a quarter of %.3g ms off", 1e3 / s.stream.expected_hz);
     },
     "candump -t d IFACE: the time from 080 to the answer",
     "Use a longer SYNC period, or lower the load, so that all answers come before the next SYNC."},
    {"rejected_frames", "has frames of a wrong length or type",
     [](const Source& s) { return s.stream.rejected + s.stream.other_forms() > 0; },
     [](const Source& s) {
         return std::to_string(s.stream.rejected + s.stream.other_forms()) + " of " +
                std::to_string(s.stream.count + s.stream.other_forms()) + " have a different length or type";
     },
     "candump IFACE,ID:MASK shows their length", "Correct the device's mapping, or the description's."},
}};

std::string with_id(std::string text, const BusStreamKey& key) {
    const std::string place = "ID:MASK";
    if (const std::size_t at = text.find(place); at != std::string::npos) {
        text.replace(at, place.size(), id_text(key).substr(2) + (key.first ? ":1FFFFFFF" : ":7FF"));
    }
    return text;
}

} // namespace

bool sends_more(const BusCheck& check, const BusStreams::value_type& source) {
    const Source asked{source.first, source.second, check};
    return asked.collides() || asked.duplicated();
}

bool is_late_or_lost(const BusCheck& check, const BusStreams::value_type& source) {
    const Source asked{source.first, source.second, check};
    return asked.loses() || asked.is_late();
}

std::vector<BusFinding> source_findings(const BusCheck& check) {
    std::vector<BusFinding> findings;
    for (const auto& [key, stream] : check.streams()) {
        const Source source{key, stream, check};
        for (const Rule& rule : rules) {
            if (rule.broken(source)) {
                const std::string sender = stream.sender.empty() ? "" : " (" + stream.sender + ")";
                findings.push_back({rule.name, id_text(key) + sender + " " + rule.what, rule.evidence(source),
                                    with_id(rule.confirm, key), rule.fix});
            }
        }
    }
    return findings;
}

} // namespace dfdyn::tools
