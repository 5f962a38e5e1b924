// SPDX-License-Identifier: Apache-2.0
#include "tools/can/bus_check.hpp"

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

double share(const BusCheck& check, double bits) {
    return check.duration_s() > 0 ? 100 * bits / check.duration_s() / check.description().bit_rate : 0;
}

void print_source(std::ostream& out, const BusCheck& check, const BusStreamKey& key,
                  const BusStream& stream) {
    out << text("%-10s %9llu %9.1f %9.1f %9.3f %9.3f %9.1f %6.1f  %s\n", id_text(key).c_str(),
                static_cast<unsigned long long>(stream.count), stream.rate_hz(), stream.expected_hz,
                1e3 * stream.jitter_s(), 1e-6 * static_cast<double>(stream.longest_gap_ns),
                stream.count > 0 ? 1e3 * check.age_s(stream) : 0.0, share(check, stream.bits),
                stream.known ? stream.sender.c_str() : "not described");
}

void print_bus(std::ostream& out, const BusCheck& check) {
    const hal::BusCounters& counters = check.counters();
    out << "bus: " << state_name(check.state()) << "; " << counters.received << " frames in "
        << text("%.3f s; load at most %.1f %% of %.0f bit/s, as described %.1f %%\n", check.duration_s(),
                100 * check.load(), check.description().bit_rate, 100 * check.expected_load());
    out << "     " << counters.dropped << " dropped, " << counters.controller_overruns << " overruns, "
        << counters.error_frames << " error frames, " << counters.lost_arbitrations << " arbitrations lost, "
        << counters.bus_off << " times bus-off, " << counters.restarted << " restarted\n";
    if (check.watch().from_host > 0) {
        out << "     " << check.watch().from_host << " frames were sent by programs of this computer\n";
    }
}

} // namespace

void print_bus_check(std::ostream& out, const BusCheck& check, std::span<const BusFinding> findings) {
    out << text("%-10s %9s %9s %9s %9s %9s %9s %6s  %s\n", "identifier", "frames", "rate/Hz", "described",
                "jitter/ms", "pause/ms", "age/ms", "load/%", "sender");
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
        out << "nothing is wrong\n";
    }
}

} // namespace dfdyn::tools
