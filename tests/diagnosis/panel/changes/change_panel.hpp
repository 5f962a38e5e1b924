// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel/changes/change_case.hpp"

#include <functional>

namespace dfdyn::tests {

/// Alarms of the monitor in one case, compared with the truth.
struct ChangeScore {
    ChangeCase change; ///< without its recording
    std::vector<tools::NamedChange> found;
    const tools::NamedChange* hit = nullptr; ///< the first alarm within ten seconds of the change
    int false_alarms = 0;                    ///< alarms before the change, or all alarms if nothing changes
    double delay_s = 0;
    double watched_s = 0; ///< time before the change, without the monitor's settling time

    bool right_cause() const { return hit != nullptr && hit->cause == *change.cause; }
    bool right_place() const { return right_cause() && hit->where == change.where; }
};

/// Scores one case for each of `cases` seeds from `seed` on. Calls `done` with each score.
std::vector<ChangeScore> run_change_panel(std::uint64_t seed, int cases, const ChangeMix& mix,
                                          const std::function<void(const ChangeScore&)>& done);

/// Describes a case in one line.
std::string describe(const ChangeScore& score);

/// Markdown tables: detections, delays, correct causes and places per cause; confusions; false alarms.
std::string change_tables(const std::vector<ChangeScore>& scores);

} // namespace dfdyn::tests
