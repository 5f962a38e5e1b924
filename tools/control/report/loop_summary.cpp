// SPDX-License-Identifier: Apache-2.0
#include "tools/control/report/loop_summary.hpp"

#include "tools/base/text/number.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

namespace {

void print_learning(std::ostream& out, const LearnedFeedForward& learned) {
    const LearningCounters& counters = learned.counters();
    out << "learning: " << counters.samples << " samples, " << counters.learned << " learned, "
        << counters.faults << " refused";
    if (counters.faults > 0) {
        out << " (last: " << name(counters.last_fault) << ')';
    }
    out << "; at most " << learned.tick_cost() << " multiply-adds per tick\n";
}

/// Returns text like "friction_changed at joint 3".
std::string described(const TakenAction& taken) {
    const std::string at = taken.joint < 0 ? "" : " at joint " + std::to_string(taken.joint + 1);
    return dfdyn::name(taken.cause) + at;
}

void print_actions(std::ostream& out, const std::vector<TakenAction>& actions) {
    for (const TakenAction& taken : actions) {
        out << "action: " << formatted("%.2f", taken.time_s) << " s: " << name(taken.action) << ", on "
            << described(taken) << '\n';
    }
}

} // namespace

void print_loop(std::ostream& out, const ControlLoop& loop) {
    const LoopCounters& counters = loop.counters();
    out << "loop: " << counters.ticks << " ticks, " << counters.running << " followed the reference, "
        << counters.coasted << " of them without position; " << counters.limited << " at a torque limit; "
        << name(loop.state()) << " (" << name(loop.cause());
    if (loop.cause() == StopCause::finding) {
        out << ": " << described(loop.actions().back());
    } else if (loop.cause() >= StopCause::overspeed) {
        out << " of joint " << loop.stopped_by() + 1;
    }
    out << ')' << (loop.brake_requested() ? ", brakes requested" : "") << (loop.limp() ? ", limp" : "")
        << '\n';
    if (const LearnedFeedForward* const learned = loop.feed_forward().learned()) {
        print_learning(out, *learned);
    }
    print_actions(out, loop.actions());
}

void print_port(std::ostream& out, const PortCounters& counters) {
    out << "bus: " << counters.received << " frames, at most " << counters.most_in_tick << " in a tick, "
        << counters.overfull_ticks << " ticks left some; " << counters.incomplete
        << " ticks without a complete sample, " << counters.held << " with joints missing, "
        << counters.invalid << " with one not believed";
    if (counters.invalid > 0) {
        out << " (last: " << hal::name(counters.last_reason);
        if (counters.last_joint != hal::unused_joint) {
            out << " of joint " << counters.last_joint + 1;
        }
        out << ')';
    }
    if (counters.clock_jumps > 0) {
        out << "; " << counters.clock_jumps << " clock jumps corrected";
    }
    out << "; " << counters.refused << " command frames refused\n";
}

void print_pace(std::ostream& out, const PaceOutcome& pace) {
    if (!pace.not_real_time.empty()) {
        out << "note: the timing is that of an ordinary program (" << pace.not_real_time << ")\n";
    }
    constexpr std::int64_t ns_per_us = 1000;
    out << "pace: " << pace.counters.ticks << " ticks, " << pace.counters.missed
        << " deadlines missed, at most " << pace.counters.worst_late_ns / ns_per_us
        << " us late, longest tick " << pace.counters.longest_ns / ns_per_us << " us\n";
}

} // namespace dfdyn::tools
