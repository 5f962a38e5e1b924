// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel/recording/panel_case.hpp"
#include "tools/diagnosis/diagnosis.hpp"

#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tests {

/// Result for one hidden effect.
struct EffectScore {
    std::string effect, where;
    double strength = 0, evidence = 0;
    bool named = false;                   ///< a finding has its name and place
    bool in_class = false;                ///< or its class of at most three causes contains it
    bool alone = false;                   ///< this finding has no ties
    std::string named_as;                 ///< the finding reported instead, or empty
    std::optional<double> relative_error; ///< of the main parameter
    bool in_interval = false;

    bool found() const { return named || in_class; }
};

/// Result for one finding.
struct FindingScore {
    std::string effect, where;
    double confidence = 0;
    double margin_to_nothing = 0, margin_to_others = 0;
    std::size_t ties = 0;
    bool right = false; ///< the finding or its class is true
    bool own_name = false;
    bool ordinary = false; ///< names the friction or the rotor of an arm that has them at all joints
};

/// Estimate of a torque constant that was not given.
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
    std::vector<std::string> refusals; ///< with codes, if the set-up or the recording is refused
    std::vector<ConstantScore> constants;
    /// Relative increase of the held-out error over all outputs by the causes found. Set only for recordings
    /// without any effect, with exact masses and known constants.
    std::optional<double> harm;
    bool unexplained_right = false; ///< for an effect outside the catalogue: right output and right input
    double seconds = 0;
};

/// Returns whether nothing is hidden or unknown, so that the recording differs from the model by noise only.
/// The held-out error is then measured.
bool is_exact(const PanelCase& panel_case);

CaseScore score_case(const PanelCase& panel_case, const tools::Diagnosis& diagnosis);

/// Describes a case in one line.
std::string describe(const CaseScore& score);

} // namespace dfdyn::tests
