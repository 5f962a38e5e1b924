// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel/score/panel_score.hpp"
#include "tools/report/report_table.hpp"

#include <string>
#include <vector>

namespace dfdyn::tests {

/// Number of successes in a number of trials.
struct Rate {
    int count = 0, of = 0;

    void add(bool yes) {
        ++of;
        count += yes ? 1 : 0;
    }
    double share() const { return of == 0 ? 0 : static_cast<double>(count) / of; }
};

/// Rates of the diagnosis over a panel that have targets.
struct PanelSummary {
    /// right name and place, or a class of at most three causes that contains it
    Rate found_at_3, found_at_1, found_at_03;
    Rate exact_name; ///< for strengths of at least 1 and findings without ties
    Rate parameter_within_20, parameter_in_interval; ///< for strengths of at least 1
    Rate constant_within_20, constant_in_interval;   ///< per joint with unknown torque constant
    Rate null_with_finding; ///< confidence of at least 0.5; a wrong link mass that is really wrong counts too
    int exact = 0;          ///< recordings that differ from the model by noise only
    double mean_harm = 0;   ///< mean of CaseScore::harm over these
    Rate refused;           ///< of all recordings; the set-up is always right
    Rate confident_and_wrong;              ///< among all findings with a confidence of at least 0.9
    Rate both_named, both_named_with_weak; ///< both of strength 1 or more; at least one weaker
    /// no wrong name at 0.5 or more, and the right output and input reported as unexplained; for strengths of
    /// at least 1, and for weaker effects
    Rate outside_silent, outside_weak;
};

/// Rates that are below their floors, or empty if none is. The floors are for 60 fixed recordings of 40 to 60
/// s, or for a thousand `long_recordings` of 200 s. The tables have the distances from the targets.
std::vector<std::string> setbacks(const PanelSummary& summary, bool long_recordings);

PanelSummary summarise(const std::vector<CaseScore>& scores);

/// Formats a rate like `81.0 % (17 of 21)`, and as a dash without trials.
std::string percent(const Rate& rate);

/// A statement of given confidence, and whether it was right.
struct Judged {
    double confidence = 0;
    bool right = false;
};

/// Shares of right statements by confidence.
tools::ReportTable reliability_table(const std::vector<Judged>& judged);

/// Markdown tables: summary against targets, detections per effect, confusions, and shares of right findings
/// by confidence.
std::string panel_tables(const std::vector<CaseScore>& scores);

} // namespace dfdyn::tests
