// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel_score.hpp"
#include "tools/report/report_table.hpp"

#include <string>
#include <vector>

namespace dfdyn::tests {

/// How often something was so.
struct Rate {
    int count = 0, of = 0;

    void add(bool yes) {
        ++of;
        count += yes ? 1 : 0;
    }
    double share() const { return of == 0 ? 0 : static_cast<double>(count) / of; }
};

/// What the diagnosis is to reach, and what it reached, over a panel.
struct PanelSummary {
    Rate found_at_3, found_at_1, found_at_03; ///< name and place, or a class of at most three that has it
    Rate exact_name;                          ///< strength 1 and more, where the finding has no ties
    Rate parameter_within_20, parameter_in_interval; ///< strength 1 and more
    Rate constant_within_20, constant_in_interval;   ///< per joint, where nobody gave its torque constant
    Rate null_with_finding; ///< with a confidence of 0.5 and more, a link's mass that really is off included
    int exact = 0;          ///< recordings with nothing but noise to explain
    double mean_harm = 0;   ///< of those, CaseScore::harm
    Rate confident_and_wrong;              ///< of all findings with a confidence of 0.9 and more
    Rate both_named, both_named_with_weak; ///< both of strength 1 and more; one or both weaker
    Rate outside_silent, outside_weak;     ///< no wrong name at 0.5 and more, and the right output and input
                                           ///< among what is unexplained; strength 1 and more, and weaker
};

/// What of it is worse than it has been on the tests' panels, of 60 fixed recordings of 40 to 60 s or of a
/// thousand `long_recordings` (200 s); empty: nothing. How far each was from its target is in the tables.
std::vector<std::string> setbacks(const PanelSummary& summary, bool long_recordings);

PanelSummary summarise(const std::vector<CaseScore>& scores);

/// `81.0 % (17 of 21)`; a dash for none.
std::string percent(const Rate& rate);

/// Something that was said, and whether it was so.
struct Judged {
    double confidence = 0;
    bool right = false;
};

/// How often what was said with each confidence was right.
tools::ReportTable reliability_table(const std::vector<Judged>& judged);

/// Markdown: the summary against its targets; found or not per effect; what was named instead; how often
/// findings of each confidence were right.
std::string panel_tables(const std::vector<CaseScore>& scores);

} // namespace dfdyn::tests
