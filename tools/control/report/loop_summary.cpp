// SPDX-License-Identifier: Apache-2.0
#include "tools/control/report/loop_summary.hpp"

#include "tools/base/text/number.hpp"

#include <nlohmann/json.hpp>

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

void print_lead_in(std::ostream& out, const ControlLoop& loop) {
    const JointVector& offset = loop.start_offset();
    if (loop.lead_in_s() > 0) {
        Eigen::Index joint = 0;
        const double largest = offset.cwiseAbs().maxCoeff(&joint);
        out << "start: the arm was beside the motion, joint " << joint + 1 << " by "
            << formatted("%.3g", largest) << " rad or m; led in within "
            << formatted("%.1f", loop.lead_in_s()) << " s\n";
    }
}

void print_vibrations(std::ostream& out, const ControlLoop& loop) {
    const JointVector share = loop.bandwidth_share();
    for (Eigen::Index joint = 0; joint < loop.bandwidth().size(); ++joint) {
        if (share[joint] < 1) {
            out << "vibration: joint " << joint + 1 << " lowered the observer's bandwidth to "
                << formatted("%.3g", share[joint] * loop.bandwidth()[joint]) << " rad/s, "
                << formatted("%.3g", share[joint]) << " of --observer-bandwidth\n";
        }
    }
}

/// Returns the largest factor of each joint on its limits of contacts.
std::vector<double> contact_factors(const ContactWatch::Calibration& calibration, Eigen::Index joints) {
    std::vector<double> factors;
    for (Eigen::Index joint = 0; joint < joints; ++joint) {
        const auto factor = [&](JointMotion motion) {
            return static_cast<double>(calibration.factor(static_cast<int>(joint), motion));
        };
        factors.push_back(std::max(
            {factor(JointMotion::standing), factor(JointMotion::changing), factor(JointMotion::moving)}));
    }
    return factors;
}

void print_contact_calibration(std::ostream& out, const ContactWatch::Calibration& calibration,
                               Eigen::Index joints) {
    if (calibration.abandoned()) {
        out << "contacts: not calibrated, a contact ended the measurement\n";
        return;
    }
    if (!calibration.finished()) {
        out << "contacts: not calibrated, " << formatted("%.1f", calibration.remaining_s())
            << " s of motion are missing\n";
        return;
    }
    const std::vector<double> factors = contact_factors(calibration, joints);
    const auto largest = std::ranges::max_element(factors);
    out << "contacts: calibrated, the limits are at most " << formatted("%.2f", *largest)
        << " times the model's (joint " << largest - factors.begin() + 1 << ")\n";
}

std::vector<double> values_of(const JointVector& joints) { return {joints.begin(), joints.end()}; }

} // namespace

void print_loop(std::ostream& out, const ControlLoop& loop) {
    const LoopCounters& counters = loop.counters();
    out << "loop: " << counters.ticks << " ticks, " << counters.running << " followed the reference, "
        << counters.coasted << " of them without position; " << counters.limited << " at a torque limit; "
        << name(loop.state()) << " (" << name(loop.cause());
    if (loop.cause() == StopCause::finding) {
        out << ": " << described(*loop.stopping_action());
    } else if (const auto joint = loop.stopped_by()) {
        out << " of joint " << *joint + 1;
    }
    out << ')' << (loop.brake_requested() ? ", brakes requested" : "") << (loop.limp() ? ", limp" : "")
        << '\n';
    if (const LearnedFeedForward* const learned = loop.feed_forward().learned()) {
        print_learning(out, *learned);
        if (learned->contact_calibration() != nullptr) {
            print_contact_calibration(out, *learned->contact_calibration(), loop.bandwidth().size());
        }
    }
    print_lead_in(out, loop);
    print_vibrations(out, loop);
    print_actions(out, loop.actions());
}

void print_reactions(std::ostream& out, const std::vector<PushReaction>& reactions) {
    for (const PushReaction& reaction : reactions) {
        out << "reaction: " << std::lround(1000 * reaction.after_s) << " ms after the push at "
            << formatted("%.2f", reaction.push_s) << " s\n";
    }
}

nlohmann::ordered_json reactions_json(const std::vector<PushReaction>& reactions) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const PushReaction& reaction : reactions) {
        json.push_back({{"push_s", reaction.push_s}, {"after_s", reaction.after_s}});
    }
    return json;
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

nlohmann::ordered_json loop_json(const std::string& name, const ControlLoop& loop, const LoopPeaks& peaks) {
    const LoopCounters& counters = loop.counters();
    nlohmann::ordered_json json{{"name", name},
                                {"ticks", counters.ticks},
                                {"followed_reference", counters.running},
                                {"coasted", counters.coasted},
                                {"at_torque_limit", counters.limited},
                                {"state", dfdyn::tools::name(loop.state())},
                                {"cause", dfdyn::tools::name(loop.cause())},
                                {"stopped_by_joint", nullptr},
                                {"brakes_requested", loop.brake_requested()},
                                {"limp", loop.limp()},
                                {"largest_torque_step_nm", values_of(peaks.torque_step())},
                                {"largest_speed_rad_s", values_of(peaks.speed())},
                                {"start_offset_rad", values_of(loop.start_offset())},
                                {"observer_bandwidth_share", values_of(loop.bandwidth_share())},
                                {"learning", nullptr},
                                {"contact_calibration", nullptr},
                                {"actions", nlohmann::ordered_json::array()}};
    if (const auto joint = loop.stopped_by()) {
        json["stopped_by_joint"] = *joint + 1;
    }
    if (const LearnedFeedForward* const learned = loop.feed_forward().learned()) {
        json["learning"] = {{"samples", learned->counters().samples},
                            {"learned", learned->counters().learned},
                            {"refused", learned->counters().faults},
                            {"multiply_adds_per_tick", learned->tick_cost()}};
        if (const auto* const calibration = learned->contact_calibration()) {
            json["contact_calibration"] = {
                {"remaining_s", calibration->remaining_s()},
                {"abandoned", calibration->abandoned()},
                {"largest_factor", calibration->finished()
                                       ? contact_factors(*calibration, loop.bandwidth().size())
                                       : std::vector<double>{}}};
        }
    }
    for (const TakenAction& taken : loop.actions()) {
        json["actions"].push_back({{"time_s", taken.time_s},
                                   {"action", dfdyn::tools::name(taken.action)},
                                   {"finding", described(taken)}});
    }
    return json;
}

nlohmann::ordered_json port_json(const PortCounters& counters) {
    return {{"received", counters.received},
            {"most_in_tick", counters.most_in_tick},
            {"overfull_ticks", counters.overfull_ticks},
            {"incomplete_ticks", counters.incomplete},
            {"ticks_with_joints_missing", counters.held},
            {"invalid_ticks", counters.invalid},
            {"clock_jumps", counters.clock_jumps},
            {"refused_commands", counters.refused}};
}

nlohmann::ordered_json pace_json(const PaceOutcome& pace) {
    return {{"ticks", pace.counters.ticks},
            {"missed", pace.counters.missed},
            {"worst_late_s", 1e-9 * static_cast<double>(pace.counters.worst_late_ns)},
            {"longest_tick_s", 1e-9 * static_cast<double>(pace.counters.longest_ns)},
            {"real_time", pace.not_real_time.empty()}};
}

} // namespace dfdyn::tools
