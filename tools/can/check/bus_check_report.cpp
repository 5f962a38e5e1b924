// SPDX-License-Identifier: Apache-2.0
#include "tools/can/check/bus_check.hpp"

#include <nlohmann/json.hpp>

#include <array>
#include <cstdio>

namespace dfdyn::tools {

namespace {

const char* state_name(hal::BusState state) {
    switch (state) {
    case hal::BusState::active:
        return "error-active";
    case hal::BusState::warning:
        return "error warning";
    case hal::BusState::passive:
        return "error-passive";
    case hal::BusState::off:
        return "bus-off";
    case hal::BusState::interface_down:
        return "interface down";
    }
    return "unknown";
}

template <class... Values>
std::string text(const char* format, Values... values) {
    std::array<char, 160> line{};
    std::snprintf(line.data(), line.size(), format, values...);
    return line.data();
}

/// Returns the share of the bit rate in percent; `-` if the bit rate is not described.
std::string load_share(const BusCheck& check, double bits) {
    const double possible_bits = check.duration_s() * check.load().bit_rate();
    return possible_bits > 0 ? text("%.1f", 100 * bits / possible_bits) : "-";
}

std::string sender_of(const BusCheck& check, const BusStream& stream) {
    return stream.known ? stream.sender : check.description() != nullptr ? "not described" : "";
}

void print_source(std::ostream& out, const BusCheck& check, const BusStreamKey& key,
                  const BusStream& stream) {
    out << text("%-10s %9llu %9.1f %9.1f %9.3f %9.3f %9.1f %6.2f %6s  ", id_text(key).c_str(),
                static_cast<unsigned long long>(stream.count), stream.rate_hz(), stream.expected_hz,
                1e3 * stream.jitter_s(), 1e-6 * static_cast<double>(stream.longest_gap_ns),
                stream.count > 0 ? 1e3 * check.age_s(stream) : 0.0, 100 * stream.missing_share(),
                load_share(check, stream.bits).c_str())
        << sender_of(check, stream) << '\n'; // may name many joints
}

std::string load_text(const BusCheck& check) {
    const BusLoad& load = check.load();
    return load.bit_rate() > 0
               ? text("load at most %.1f %% of %.0f bit/s, as described %.1f %%",
                      100 * load.mean(check.duration_s()), load.bit_rate(), 100 * load.expected())
               : "the load is not known without --bus";
}

void print_bus(std::ostream& out, const BusCheck& check) {
    const hal::BusCounters& counters = check.counters();
    out << "bus: " << state_name(check.state()) << "; " << counters.received << " frames in "
        << text("%.3f s; ", check.duration_s()) << load_text(check) << '\n';
    out << "     " << counters.dropped << " dropped, " << counters.controller_overruns << " overruns, "
        << counters.error_frames << " error frames, " << counters.lost_arbitrations << " arbitrations lost, "
        << counters.bus_off << " times bus-off, " << counters.restarted << " restarted\n";
    if (check.from_host() > 0) {
        out << "     " << check.from_host() << " frames were sent by programs of this computer\n";
    }
    for (const BusBoard& board : check.boards()) {
        if (const std::string summary = board.board->host_summary(); !summary.empty()) {
            out << "     other programs command joint " << board.joint[0] + 1 << ": " << summary << '\n';
        }
    }
}

nlohmann::ordered_json source_json(const BusCheck& check, const BusStreamKey& key, const BusStream& stream) {
    return {{"identifier", id_text(key)},
            {"frames", stream.count},
            {"rate_hz", stream.rate_hz()},
            {"expected_hz", stream.expected_hz},
            {"jitter_s", stream.jitter_s()},
            {"longest_gap_s", seconds_of(stream.longest_gap_ns)},
            {"age_s", stream.count > 0 ? check.age_s(stream) : 0},
            {"missing_share", stream.missing_share()},
            {"bits", stream.bits},
            {"sender", sender_of(check, stream)}};
}

nlohmann::ordered_json bus_json(const BusCheck& check) {
    const hal::BusCounters& counters = check.counters();
    nlohmann::ordered_json json{{"state", state_name(check.state())},
                                {"received", counters.received},
                                {"duration_s", check.duration_s()},
                                {"bit_rate", nullptr},
                                {"load", nullptr},
                                {"expected_load", nullptr},
                                {"dropped", counters.dropped},
                                {"controller_overruns", counters.controller_overruns},
                                {"error_frames", counters.error_frames},
                                {"lost_arbitrations", counters.lost_arbitrations},
                                {"bus_off", counters.bus_off},
                                {"restarted", counters.restarted},
                                {"from_host", check.from_host()}};
    if (const BusLoad& load = check.load(); load.bit_rate() > 0) {
        json["bit_rate"] = load.bit_rate();
        json["load"] = load.mean(check.duration_s());
        json["expected_load"] = load.expected();
    }
    return json;
}

} // namespace

nlohmann::ordered_json bus_check_json(const BusCheck& check, std::span<const BusFinding> findings) {
    nlohmann::ordered_json json{{"schema", "dfdyn.buscheck/1"},
                                {"bus", bus_json(check)},
                                {"sources", nlohmann::ordered_json::array()},
                                {"findings", nlohmann::ordered_json::array()}};
    for (const auto& [key, stream] : check.streams()) {
        json["sources"].push_back(source_json(check, key, stream));
    }
    for (const BusFinding& one : findings) {
        json["findings"].push_back({{"rule", one.rule},
                                    {"what", one.what},
                                    {"evidence", one.evidence},
                                    {"confirm", one.confirm},
                                    {"fix", one.fix}});
    }
    return json;
}

void print_bus_check(std::ostream& out, const BusCheck& check, std::span<const BusFinding> findings) {
    out << text("%-10s %9s %9s %9s %9s %9s %9s %6s %6s  %s\n", "identifier", "frames", "rate/Hz",
                check.description() != nullptr ? "described" : "steady", "jitter/ms", "pause/ms", "age/ms",
                "lost/%", "load/%", "sender");
    for (const auto& [key, stream] : check.streams()) {
        print_source(out, check, key, stream);
    }
    print_bus(out, check);
    for (const BusFinding& finding : findings) {
        out << "\n"
            << finding.rule << ": " << finding.what << "\n  inferred from: " << finding.evidence
            << "\n  to confirm:    " << finding.confirm << "\n  to fix:        " << finding.fix << '\n';
    }
    if (findings.empty()) {
        out << "no fault found\n";
    }
}

} // namespace dfdyn::tools
