// SPDX-License-Identifier: Apache-2.0
// How often the faults of a campaign changed the traffic. A fault without an effect proves nothing.
#pragma once

#include "tests/hal/campaign/fault_actions.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <map>

namespace dfdyn::tests {

/// How often a fault was placed: on any arm, on arms that can have it, and with a change of the traffic.
struct FaultCount {
    std::uint64_t placed = 0, possible = 0, effective = 0;
};

/// By the fault's number.
using FaultCounts = std::map<int, FaultCount>;

/// Returns true if the same frames arrive at the same times in the same order.
inline bool same_frames(const Traffic& one, const Traffic& other) {
    return std::ranges::equal(one, other, [](const Sent& a, const Sent& b) {
        const hal::Frame& x = a.frame;
        const hal::Frame& y = b.frame;
        return a.true_ns == b.true_ns && x.stamp_ns == y.stamp_ns && x.id == y.id && x.length == y.length &&
               x.extended == y.extended && x.remote == y.remote && x.error == y.error && x.fd == y.fd &&
               x.data == y.data;
    });
}

inline bool is_one_of(const Fault& fault, std::initializer_list<void (*)(FaultSite&)> actions) {
    return std::ranges::find(actions, fault.apply) != actions.end();
}

/// Returns true if the arm has what the fault affects: a sensor, efforts, SYNCs, or two boards.
inline bool can_have(const CampaignArm& arm, const Fault& fault) {
    if (is_one_of(fault, {silence_sensor, freeze_sensor, saturate_sensor, second_sensor})) {
        return !arm.efforts();
    }
    if (is_one_of(fault, {freeze_effort, saturate_effort})) {
        return arm.efforts();
    }
    if (is_one_of(fault, {lose_syncs, late_answers})) {
        return arm.synchronous;
    }
    return fault.apply != swap_nodes || arm.boards == 2;
}

inline void add(FaultCount& sum, const FaultCount& more) {
    sum.placed += more.placed;
    sum.possible += more.possible;
    sum.effective += more.effective;
}

/// Placements after which a fault must have changed some traffic.
struct OftenEnough {
    std::uint64_t of_any;
    std::uint64_t in_motion; ///< of a fault that waits for a fast joint: up to two thirds have no effect
};

/// Checks that each fault that was placed often enough changed some traffic.
inline void check_effects(const FaultCounts& counts, const OftenEnough& enough) {
    for (const Fault& fault : campaign_faults()) {
        const auto found = counts.find(fault.number);
        const FaultCount count = found == counts.end() ? FaultCount{} : found->second;
        const bool in_motion = is_one_of(fault, {freeze_encoder, freeze_effort, replay_old});
        CAPTURE(fault.number, fault.name, count.placed, count.possible, count.effective);
        CHECK((count.effective > 0 || count.possible < (in_motion ? enough.in_motion : enough.of_any)));
    }
}

} // namespace dfdyn::tests
