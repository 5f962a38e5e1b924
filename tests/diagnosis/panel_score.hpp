// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel_case.hpp"
#include "tools/diagnosis/diagnosis.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tests {

/// What became of one hidden effect.
struct EffectScore {
    std::string effect, where;
    double strength = 0, evidence = 0;
    bool named = false;                   ///< the finding's own name and place
    bool in_class = false;                ///< or a class of at most three that has it
    bool alone = false;                   ///< the finding that has it has no ties
    std::string named_as;                 ///< what was found instead, or nothing
    std::optional<double> relative_error; ///< of the main parameter
    bool in_interval = false;

    bool found() const { return named || in_class; }
};

/// What became of one finding.
struct FindingScore {
    std::string effect, where;
    double confidence = 0;
    double margin_to_nothing = 0, margin_to_others = 0;
    std::size_t ties = 0;
    bool right = false; ///< it, or its class, is there
    bool own_name = false;
};

/// What was said of a torque constant that was not given.
struct ConstantScore {
    double relative_error = 0;
    bool in_interval = false;
};

struct CaseScore {
    std::uint64_t seed = 0;
    std::string robot, noise;
    bool masses_off = false, outside = false;
    std::vector<EffectScore> effects;
    std::vector<FindingScore> findings;
    std::vector<ConstantScore> constants;
    /// Without any effect, masses exact and constants known: by what share the model with the causes, if
    /// there are any, errs more on held-out time than the one without, over all outputs.
    std::optional<double> harm;
    bool unexplained_right = false; ///< outside the catalogue: the right output, by the right input
    double seconds = 0;
};

/// Nothing is hidden, and nothing unknown: there is nothing to explain but noise. The held-out error is to be
/// measured then.
bool is_exact(const PanelCase& panel_case);

CaseScore score_case(const PanelCase& panel_case, const tools::Diagnosis& diagnosis);

/// One line for people.
std::string describe(const CaseScore& score);

} // namespace dfdyn::tests
