// SPDX-License-Identifier: Apache-2.0
// Rules for faults of a bus and for conditions reported by devices, one rule each.
#include "tools/can/check/bus_check.hpp"

#include "tools/base/text/number.hpp"
#include "tools/can/families/family.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dfdyn::tools {

namespace {

constexpr double largest_load = 0.8;
constexpr double largest_unknown_load = 0.1;
constexpr double largest_unknown_peak = 0.25; ///< load in 0.2 s
/// share of the samples or frames; for conditions that may occur occasionally
constexpr double least_refused = 0.01;

std::string counted(std::uint64_t count, const char* of) {
    return count > 0 ? std::to_string(count) + of : std::string();
}

bool is_silent(const BusCheck& check) {
    return std::ranges::all_of(check.streams(), [](const auto& entry) { return entry.second.count == 0; });
}

std::string silence(const BusCheck& check) {
    return is_silent(check) ? "no frame in " + number_text(check.duration_s()) + " s" : "";
}

std::string overload(const BusCheck& check) {
    const double mean = check.load().mean(check.duration_s());
    const double expected = check.load().expected();
    if (check.load().peak() > largest_load && mean <= largest_load) {
        return percent(check.load().peak()) +
               " of the bit rate in the busiest 0.2 s, with worst-case bit stuffing; on average " +
               percent(mean);
    }
    const double load = std::max(mean, expected);
    const char* const how = mean >= expected ? " measured" : " as described";
    return load > largest_load ? percent(load) + " of the bit rate" + how + ", with worst-case bit stuffing"
                               : "";
}

std::string strangers(const BusCheck& check) {
    double bits = 0;
    int identifiers = 0;
    std::string first;
    for (const auto& [key, stream] : check.streams()) {
        if (!stream.known) {
            first = identifiers == 0 ? id_text(key) : first;
            bits += stream.bits;
            ++identifiers;
        }
    }
    const double possible_bits = check.duration_s() * check.load().bit_rate();
    const double share = possible_bits > 0 ? bits / possible_bits : 0;
    if (share <= largest_unknown_load && check.load().peak_unknown() > largest_unknown_peak) {
        return percent(check.load().peak_unknown()) + " of the bit rate in the busiest 0.2 s, on " +
               std::to_string(identifiers) + " undescribed identifiers, first " + first;
    }
    return share > largest_unknown_load
               ? percent(share) + " of the bit rate on " + std::to_string(identifiers) +
                     " undescribed identifiers, first " + first
               : "";
}

std::string errors(const BusCheck& check) {
    const hal::BusState worst = check.worst_state();
    if (worst == hal::BusState::warning || worst == hal::BusState::passive) {
        return std::string("an error counter beyond ") + (worst == hal::BusState::passive ? "127" : "95");
    }
    return "";
}

std::string jumps(const BusCheck& check) {
    const StreamClock& clock = check.clock();
    std::string text;
    if (clock.steps() > 0) {
        const double step_s = seconds_of(clock.largest_step_ns());
        text = "all stamps go " + number_text(std::abs(step_s)) + " s " + (step_s < 0 ? "back" : "ahead") +
               " at once" +
               (clock.steps() > 1 ? ", or less, " + std::to_string(clock.steps()) + " times" : "") +
               (step_s < 0 ? "" : " (or the whole bus was silent for this time)");
    }
    if (const std::int64_t step_ns = common_phase_step_ns(check.streams()); step_ns != 0 && text.empty()) {
        text = formatted("all sources change their phase by %.3g ms at once",
                         1e-6 * static_cast<double>(step_ns));
    }
    if (clock.strays() > 0) {
        text +=
            (text.empty() ? "" : "; ") + counted(clock.strays(), " stamps far from those before and after");
    }
    return text;
}

std::string repeated_times(const BusCheck& check) {
    std::uint64_t frames = 0, not_increasing = 0;
    for (const auto& [key, stream] : check.streams()) {
        frames += stream.count;
        not_increasing += stream.not_increasing;
    }
    return static_cast<double>(not_increasing) > least_refused * static_cast<double>(frames)
               ? std::to_string(not_increasing) + " of " + std::to_string(frames) +
                     " frames are not later than the one before on their identifier"
               : "";
}

std::string overtaken(const BusCheck& check) {
    return check.order().differs() && repeated_times(check).empty()
               ? counted(check.order().overtaken(), " frames were read after one with a later stamp")
               : "";
}

struct BusRule {
    const char* name;
    const char* what;
    std::string (*evidence)(const BusCheck&); ///< empty: no fault
    const char* confirm;
    const char* fix;
};

constexpr std::array<BusRule, 13> bus_rules{{
    {"silent_bus", "no frame is sent", silence, "candump IFACE; ip -details link show IFACE",
     "Set the interface up with the devices' bit rate. Check power and cable. Check the interface's name."},
    {"overload", "the load of the bus leaves no margin", overload,
     "ip -details link show IFACE shows the bit rate; canbusload IFACE@BITRATE measures the load",
     "Use a second bus, lower rates, or CAN FD."},
    {"unknown_traffic", "undescribed devices cause much of the load", strangers,
     "unplug devices until the traffic ends", "Remove these devices from the bus, or reduce their rates."},
    {"bus_off", "the controller went bus-off",
     [](const BusCheck& check) { return counted(check.counters().bus_off, " times bus-off"); },
     "ip -details -statistics link show IFACE: the state, the error counters, restart-ms",
     "Find the short circuit, the wrong bit rate or the missing termination. Set restart-ms for a restart."},
    {"error_passive", "the controller detects many errors", errors,
     "switch the power off and measure 60 Ohm between CAN-H and CAN-L",
     "Check termination, cable, and the bit rate of every node."},
    {"wire_errors", "bit, form or checksum errors on the wire",
     [](const BusCheck& check) {
         return counted(check.counters().bus_errors, " error frames for errors on the wire");
     },
     "look at CAN-H and CAN-L with an oscilloscope; unplug devices until the errors end",
     "Check termination, cable, stubs and grounding. Check that no two devices send on one identifier."},
    {"no_acknowledgement", "no other node acknowledges frames",
     [](const BusCheck& check) {
         return counted(check.counters().no_acknowledgements, " frames without an acknowledgement");
     },
     "power another node on the bus: the errors end",
     "Connect and power the other nodes. Set the same bit rate everywhere."},
    {"frames_dropped", "this computer lost frames",
     [](const BusCheck& check) {
         return counted(check.counters().dropped + check.counters().controller_overruns,
                        " frames dropped or overrun");
     },
     "ip -details -statistics link show IFACE: dropped, overrun",
     "Read more often and at a real-time priority. Filter identifiers. Set a larger receive buffer "
     "(net.core.rmem_max)."},
    {"device_lost_frames", "a device lost messages",
     [](const BusCheck& check) { return counted(check.device_losses(), " reports of a device"); },
     "read the device's status", "Send less to it. Lower the load of the bus."},
    {"interface_down", "the interface went down",
     [](const BusCheck& check) { return counted(check.counters().interface_down, " times down"); },
     "ip link show IFACE", "Run ip link set IFACE up. Check the adapter and its cable."},
    {"clock_jumped", "time stamps jump", jumps, "timedatectl; journalctl -u systemd-timesyncd",
     "Do not set the clock while recording. Use the time stamps of the adapter's hardware."},
    {"time_not_increasing", "time stamps repeat or run backward", repeated_times, "candump -t d IFACE",
     "Use the time stamps of the kernel, not of the program that reads."},
    {"frames_overtaken", "the order of reading differs from the order of the stamps", overtaken,
     "candump -t a IFACE: the stamps go back by less than a period",
     "Read all frames of an adapter from one receive queue. Use one adapter for one bus."},
}};

struct DeviceRule {
    hal::Reason reason;
    enum { ever, often, at_end } when;
    const char* name;
    const char* what;
    const char* confirm;
    const char* fix;
};

constexpr std::array<DeviceRule, 13> device_rules{{
    {hal::Reason::encoder_fault, DeviceRule::ever, "encoder_fault", "a board reports an encoder error",
     "read the board's status", "Check the encoder and its cable."},
    {hal::Reason::device_fault, DeviceRule::ever, "device_fault", "a device reports a fault",
     "read the device's error code", "Remove the cause, then clear the fault."},
    {hal::Reason::device_not_operational, DeviceRule::ever, "not_operational",
     "a device is not in its operational state", "", ""}, // JointFamily::not_operational
    {hal::Reason::heartbeat_missing, DeviceRule::often, "heartbeat_missing",
     "a required heartbeat is missing", "candump IFACE shows whether it is sent",
     "Enable the device's heartbeat. Correct heartbeat_timeout_s in the description."},
    {hal::Reason::qualifying, DeviceRule::at_end, "zeros",
     "a source sends only zeros, or too few values to qualify", "move the joint, or load the sensor",
     "Wait until the encoder has found its position. Calibrate it."},
    {hal::Reason::position_out_of_range, DeviceRule::ever, "position_out_of_range",
     "a position is beyond the range of the joint", "read the angle with the maker's own program",
     "Correct scale and zero, or limit_rad, in the description."},
    {hal::Reason::output_out_of_range, DeviceRule::ever, "output_out_of_range",
     "an output is beyond the range of the sensor", "unload the sensor and look again",
     "Correct full scale, calibration or limit in the description."},
    {hal::Reason::output_saturated, DeviceRule::ever, "sensor_saturated",
     "the sensor is overloaded, or its converter is saturated", "unload the sensor and look again",
     "Reduce the load, or use a sensor of larger range."},
    {hal::Reason::output_frozen, DeviceRule::ever, "sensor_frozen", "the sensor repeats the same raw values",
     "touch the sensor: the bytes do not change (candump -c IFACE)", "Restart the sensor."},
    {hal::Reason::output_incomplete, DeviceRule::often, "incomplete_wrench",
     "one of the two frames of a wrench is missing or late", "candump -t d IFACE,300:700",
     "Check the second identifier. Lower the load of the bus. Correct pair_window_s in the description."},
    {hal::Reason::waiting_for_full_scale, DeviceRule::at_end, "full_scale_unknown",
     "the sensor has not reported its full scale, without which its values cannot be scaled",
     "request it: cansend IFACE ID#1800, and 01 to 05",
     "Run dfdyn replay --can, which requests it, or set full_scale in the description."},
    {hal::Reason::full_scale_contradicted, DeviceRule::ever, "full_scale_contradicted",
     "the sensor reports a full scale that differs from the described or the previous one",
     "request the full scale of each channel: cansend IFACE ID#1800, and 01 to 05",
     "Describe the full scales of the set in use. Do not change the set while the arm runs."},
    {hal::Reason::full_scale_implausible, DeviceRule::ever, "full_scale",
     "the sensor's full scale is implausible", "request the full scale of each channel",
     "Correct it in the sensor or the description."},
}};

/// Returns true if zero readings are possible. A source also qualifies after each gap.
bool may_be_zero(const BusCheck& check) {
    return check.sensor() != nullptr || std::ranges::any_of(check.joints(), [](const CheckedJoint& joint) {
               return joint.values.at_zero();
           });
}

bool holds(const DeviceRule& rule, const BusCheck& check) {
    const std::uint64_t refused = check.samples().count(rule.reason);
    switch (rule.when) {
    case DeviceRule::often:
        return static_cast<double>(refused) > least_refused * static_cast<double>(check.samples().total());
    case DeviceRule::at_end:
        return check.samples().last_has(rule.reason) &&
               (rule.reason != hal::Reason::qualifying || may_be_zero(check));
    case DeviceRule::ever:
        break;
    }
    return refused > 0;
}

/// Returns the finding of a rule that holds. Requires a description.
BusFinding device_finding(const DeviceRule& rule, const BusCheck& check) {
    BusFinding finding{rule.name, rule.what,
                       std::to_string(check.samples().count(rule.reason)) + " of " +
                           std::to_string(check.samples().total()) + " samples: " + hal::name(rule.reason),
                       rule.confirm, rule.fix};
    if (rule.reason == hal::Reason::device_not_operational) {
        const Remedy& remedy = check.description()->joint_family->not_operational;
        finding.confirm = remedy.confirm;
        finding.fix = remedy.fix;
    }
    return finding;
}

} // namespace

std::vector<BusFinding> bus_findings(const BusCheck& check) {
    std::vector<BusFinding> findings;
    for (const BusRule& rule : bus_rules) {
        if (std::string evidence = rule.evidence(check); !evidence.empty()) {
            findings.push_back({rule.name, rule.what, std::move(evidence), rule.confirm, rule.fix});
        }
    }
    if (is_silent(check)) {
        return findings; // on a silent bus every source is silent
    }
    std::ranges::move(source_findings(check), std::back_inserter(findings));
    std::ranges::move(value_findings(check), std::back_inserter(findings));
    const bool sensor = check.sensor() != nullptr;
    const bool sensor_is_late = std::ranges::any_of(check.streams(), [&](const auto& source) {
        return source.second.of_sensor && is_late_or_lost(check, source);
    });
    for (const DeviceRule& rule : device_rules) {
        // Efforts of joints have their own rules.
        const bool of_sensor =
            rule.reason == hal::Reason::output_saturated || rule.reason == hal::Reason::output_frozen;
        const bool explained = sensor_is_late && rule.reason == hal::Reason::output_incomplete;
        if (holds(rule, check) && (sensor || !of_sensor) && !explained) {
            findings.push_back(device_finding(rule, check));
        }
    }
    return findings;
}

} // namespace dfdyn::tools
