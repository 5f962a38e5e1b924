// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/change_case.hpp"

#include <functional>

namespace dfdyn::tests {

/// What the monitor said of a case.
struct ChangeScore {
    ChangeCase change; ///< without its recording
    std::vector<tools::NamedChange> found;
    const tools::NamedChange* hit = nullptr; ///< the first alarm within ten seconds of the change
    int false_alarms = 0;                    ///< before it, or where there is none
    double delay_s = 0;
    double watched_s = 0; ///< before the change, since the monitor has settled

    bool right_cause() const { return hit != nullptr && hit->cause == *change.cause; }
    bool right_place() const { return right_cause() && hit->where == change.where; }
};

/// Of the seeds from `seed` on, one case each. `done` is told of each.
std::vector<ChangeScore> run_change_panel(std::uint64_t seed, int cases, const ChangeMix& mix,
                                          const std::function<void(const ChangeScore&)>& done);

/// A line on one case.
std::string describe(const ChangeScore& score);

/// Detected, delay, cause and place per cause; what was named instead; false alarms. Markdown.
std::string change_tables(const std::vector<ChangeScore>& scores);

} // namespace dfdyn::tests
