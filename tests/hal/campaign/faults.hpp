// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/hal/campaign/arm.hpp"

#include <algorithm>
#include <span>
#include <vector>

namespace dfdyn::tests {

/// Traffic into which a fault is injected, and its time.
struct FaultSite {
    const CampaignArm& arm;
    Traffic& traffic; ///< in order of true time
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
    [[nodiscard]] std::size_t pick_joint() const { return static_cast<std::size_t>(pick(2)); }
    [[nodiscard]] bool chance(double share) const { return std::bernoulli_distribution(share)(engine); }

    [[nodiscard]] static bool is_device(const Sent& sent) {
        return sent.role == Sent::Role::joints || sent.role == Sent::Role::wrench;
    }
    [[nodiscard]] const CampaignArm::Fields& fields(const Sent& sent) const {
        return arm.fields[sent.unit][sent.part];
    }
    [[nodiscard]] bool has_position(const Sent& sent, std::size_t joint) const {
        return sent.role == Sent::Role::joints && any(fields(sent).position[joint]);
    }
    /// Returns true if a receiver uses this frame's position. Others may contain it in fewer bits.
    [[nodiscard]] bool is_reading(const Sent& sent, std::size_t joint) const {
        return has_position(sent, joint) &&
               std::ranges::none_of(arm.fields[sent.unit], [&](const CampaignArm::Fields& part) {
                   return count(part.position[joint]) > count(fields(sent).position[joint]);
               });
    }
    /// Includes frames of another form, which a frozen effort affects, too.
    [[nodiscard]] bool has_effort(const Sent& sent, std::size_t joint) const {
        return (sent.role == Sent::Role::joints || sent.other_form) && any(fields(sent).effort[joint]);
    }
    /// Returns true if the frame comes from the board of this joint.
    [[nodiscard]] bool is_joint(const Sent& sent, std::size_t joint) const {
        return has_position(sent, joint) || has_effort(sent, joint);
    }

    /// Replaces the position, or the effort, of a joint in a frame.
    void show_position(Sent& sent, std::size_t joint, double position_rad) const;
    void show_effort(Sent& sent, std::size_t joint, double effort) const;

    /// Removes the frames during the fault for which `drop` is true.
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
    /// Adds frames made from those during the fault.
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
    /// Delays the start until this joint moves fast. Returns false, without a fault, if it never does.
    [[nodiscard]] bool wait_for_motion(std::size_t joint, double least_rad_s);
    void sort() const { std::ranges::stable_sort(traffic, {}, &Sent::true_ns); }
};

/// One fault of the legend (docs/reference/faults.md).
struct Fault {
    int number;
    const char* name;
    double shortest_s, longest_s;
    void (*apply)(FaultSite& site);
    double recovery_s = 0.5; ///< from its end until joints are trusted again
    /// Time from its start in which outputs cannot be distinguished from good ones.
    double undetectable_s = 0;
    bool stays = false; ///< its effect lasts until the end of the run
    /// May change outputs by less than any limit.
    bool alters_outputs = false;
    /// Undetectable delay, or advance, of outputs relative to their stamps.
    double late_s = 0, early_s = 0;
    /// Largest common delay of all frames without a stamp of their device.
    double waits_s = 0;
};

/// Returns the faults of the legend that affect a bus. An absolute encoder has no restart of an incremental
/// one.
std::vector<Fault> campaign_faults(hal::Encoder encoder = hal::Encoder::unknown);

} // namespace dfdyn::tests
