// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/hal/campaign/arm.hpp"

#include <algorithm>
#include <span>

namespace dfdyn::tests {

/// What a fault is put into.
struct FaultSite {
    const CampaignArm& arm;
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
    /// Whether a receiver takes the joint's position from it. Other frames may have it, too, in fewer bits.
    [[nodiscard]] bool is_reading(const Sent& sent, std::size_t joint) const {
        return has_position(sent, joint) &&
               std::ranges::none_of(arm.fields[sent.unit], [&](const CampaignArm::Fields& part) {
                   return count(part.position[joint]) > count(fields(sent).position[joint]);
               });
    }
    /// Also in frames of another form: a frozen effort is so there, too.
    [[nodiscard]] bool has_effort(const Sent& sent, std::size_t joint) const {
        return (sent.role == Sent::Role::joints || sent.other_form) && any(fields(sent).effort[joint]);
    }
    /// Whether it is of the board of this joint.
    [[nodiscard]] bool is_joint(const Sent& sent, std::size_t joint) const {
        return has_position(sent, joint) || has_effort(sent, joint);
    }

    /// Puts another position, or effort, of a joint into a frame.
    void show_position(Sent& sent, std::size_t joint, double position_rad) const;
    void show_effort(Sent& sent, std::size_t joint, double effort) const;

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
    [[nodiscard]] bool wait_for_motion(std::size_t joint, double least_rad_s);
    void sort() const { std::ranges::stable_sort(traffic, {}, &Sent::true_ns); }
};

/// One fault of the legend (docs/reference/faults.md).
struct Fault {
    int number;
    const char* name;
    double shortest_s, longest_s;
    void (*apply)(FaultSite& site);
    double recovery_s = 0.5; ///< after its end, until joints are trusted again
    /// For so long from its begin no receiver can tell what it shows from good outputs.
    double undetectable_s = 0;
    bool stays = false; ///< what it changed stays so until the end
    /// It may change outputs by so little that no limit shows it.
    bool alters_outputs = false;
    /// By how much outputs may be older, or newer, than their stamps without a sign of it.
    double late_s = 0, early_s = 0;
    /// By how much all frames without a stamp of their device come late, one as much as the next.
    double waits_s = 0;
};

/// The faults of the legend that are on a bus.
std::span<const Fault> campaign_faults();

} // namespace dfdyn::tests
