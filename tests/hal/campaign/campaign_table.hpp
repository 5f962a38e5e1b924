// SPDX-License-Identifier: Apache-2.0
// Output and checks of the campaign.
#pragma once

#include "tests/hal/campaign/campaign.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <iomanip>
#include <iostream>

namespace dfdyn::tests {

inline const char* name_of(Trigger trigger) {
    return trigger == Trigger::timer ? "timer" : trigger == Trigger::set ? "set" : "sync";
}

inline double share(std::uint64_t part, std::uint64_t of) {
    return static_cast<double>(part) / std::max(1.0, static_cast<double>(of));
}

inline void print_header() {
    std::cout
        << "seed " << seed()
        << "\n| family and output | trigger | frames | faults | accepted | outputs | undecidable | wrong | "
        << "refused although good |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n";
}
inline void print(const CampaignRow& row, const char* trigger) {
    std::cout << "| " << row.family << " | " << trigger << " | " << row.frames << " | " << row.faults << " | "
              << row.accepted << " | " << row.outputs << " | "
              << row.undecidable_positions + row.undecidable_outputs << " | "
              << row.wrong_positions + row.wrong_outputs << " | " << std::fixed << std::setprecision(2)
              << 100 * share(row.refused_good, row.good) << " % |\n";
}

/// The joints' encoders as the receiver has them described, and as they are.
struct Encoders {
    hal::Encoder described = hal::Encoder::unknown;
    hal::Encoder real = hal::Encoder::unknown;
};

/// Runs one family and trigger, and adds its row to the sum. Only in long runs is a fault
/// placed often enough to check that it changes the traffic of this family.
inline void fight(const CampaignArm& arm, Trigger trigger, const Encoders& encoders, std::uint64_t frames,
                  std::mt19937_64& engine, CampaignRow& sum) {
    const CampaignRow row =
        Campaign(arm, trigger, encoders.described, engine).run(frames, campaign_faults(encoders.real));
    print(row, name_of(trigger));
    CAPTURE(row.family);
    check_effects(row.effects, {.of_any = 5, .in_motion = 30});
    for (const auto& [number, count] : row.effects) {
        add(sum.effects[number], count);
    }
    sum.wrong.insert(sum.wrong.end(), row.wrong.begin(), row.wrong.end());
    sum.frames += row.frames;
    sum.faults += row.faults;
    sum.samples += row.samples;
    sum.accepted += row.accepted;
    sum.outputs += row.outputs;
    sum.wrong_positions += row.wrong_positions;
    sum.wrong_outputs += row.wrong_outputs;
    sum.undecidable_positions += row.undecidable_positions;
    sum.undecidable_outputs += row.undecidable_outputs;
    sum.good += row.good;
    sum.refused_good += row.refused_good;
    sum.unlearned_good += row.unlearned_good;
}

/// Prints the sum and checks the limits over all families. `most_wrong`: share of the accepted samples;
/// `most_refused`: of the good ones; `most_undecidable`: of the accepted ones, and of their outputs.
inline void check_sum(CampaignRow sum, double most_wrong, double most_refused,
                      double most_undecidable = 0.02) {
    sum.family = "all";
    print(sum, "");
    constexpr std::size_t least_placed = 28; // of 31 or 32 faults
    CHECK(sum.effects.size() >= least_placed);
    check_effects(sum.effects, {.of_any = 3, .in_motion = 8});
    for (const std::string& wrong : sum.wrong) {
        std::cout << "wrong " << wrong << '\n';
    }
    CHECK(share(sum.wrong_positions + sum.wrong_outputs, sum.accepted) <= most_wrong);
    CHECK(sum.accepted > sum.samples / 3); // rejecting everything is not enough
    CHECK(share(sum.undecidable_positions, sum.accepted) < most_undecidable);
    CHECK(share(sum.undecidable_outputs, sum.outputs) < most_undecidable);
    CHECK(share(sum.refused_good, sum.good) < most_refused);
    CHECK(share(sum.unlearned_good, sum.good) < 0.01);
}

} // namespace dfdyn::tests
