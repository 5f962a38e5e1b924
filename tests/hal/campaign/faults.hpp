// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/hal/campaign/arms.hpp"

#include <span>

namespace dfdyn::tests {

/// What a fault is put into.
struct FaultSite {
    Traffic& traffic; ///< in the order of true time
    std::int64_t begin_ns;
    std::int64_t end_ns;
    std::mt19937_64& engine;
    const Truth& truth;

    [[nodiscard]] bool covers(const Sent& sent) const {
        return sent.true_ns >= begin_ns && sent.true_ns < end_ns;
    }
    [[nodiscard]] int pick(int count) const {
        return std::uniform_int_distribution<int>(0, count - 1)(engine);
    }
    [[nodiscard]] bool chance(double share) const { return std::bernoulli_distribution(share)(engine); }

    /// Removes the frames of the fault's time for which `drop` holds.
    template <class Drop>
    void remove(Drop drop) const {
        std::erase_if(traffic, [&](const Sent& sent) { return covers(sent) && drop(sent); });
    }
    template <class Change>
    void change(Change change) const {
        for (Sent& sent : traffic) {
            if (covers(sent)) {
                change(sent);
            }
        }
    }
    /// Adds frames made from those of the fault's time.
    template <class Make>
    void add(Make make) const {
        Traffic more;
        for (const Sent& sent : traffic) {
            if (covers(sent)) {
                make(sent, more);
            }
        }
        traffic.insert(traffic.end(), more.begin(), more.end());
        sort();
    }
    /// Moves the begin to where this joint moves fast; the fault is left out where it does not.
    [[nodiscard]] bool wait_for_motion(int joint, double least_rad_s);
    void sort() const { std::ranges::stable_sort(traffic, {}, &Sent::true_ns); }
};

/// What a fault does to what can be known of a joint's motion.
enum class Effect {
    none,    ///< nothing: it is about the output
    spoils,  ///< single values are bad, late or missing
    hides,   ///< for a while nothing is known of the joint
    misleads ///< the joint shows another motion than its own
};

/// Whether two faults may be at the same time. Nobody can tell a motion that is not the joint's own where it
/// begins while the joint's own is not seen well; nor how long a silence was during which the clock was set.
constexpr bool mix(Effect one, Effect other) {
    const auto either = [&](Effect effect) { return one == effect || other == effect; };
    return either(Effect::none) || (either(Effect::spoils) && !either(Effect::misleads));
}

/// One fault of the legend (docs/reference/faults.md).
struct Fault {
    int number;
    const char* name;
    double shortest_s, longest_s;
    void (*apply)(FaultSite& site);
    double recovery_s = 0.06; ///< after its end: qualification, and what is in between
    Effect effect = Effect::none;
    bool ends = true; ///< false: what it changed stays so
    /// For so long from its begin no receiver can tell what it shows from good outputs.
    double undetectable_s = 0;
    /// It may change values by so little that no limit shows it.
    bool alters_positions = false, alters_outputs = false;
    /// By how much outputs may be older, or newer, than their stamps without a sign of it.
    double late_s = 0, early_s = 0;
    /// By how much all frames without a stamp of their device come late, one as much as the next.
    double waits_s = 0;
};

/// The faults of the legend that are on a bus.
std::span<const Fault> campaign_faults();

} // namespace dfdyn::tests
