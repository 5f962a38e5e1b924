// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/cause.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// What a loop does when the learner's monitor has named a change.
enum class FindingAction : std::uint8_t {
    report,     ///< nothing: the change is in the report
    relearn,    ///< the learner's covariance goes back to the prior's: it soon follows what is measured now
    compensate, ///< the offset that was estimated is added to the nominal torque
    stop,       ///< the loop stops, see StopCause::finding
};

const char* name(FindingAction action) noexcept;

/// An action for each cause; without a choice all are reported.
class FindingActions {
  public:
    /// Confidence from which on a finding is acted on: with the others the loop goes on, and feedback and
    /// learner correct what was wrong.
    static constexpr double least_confidence(FindingAction action) noexcept {
        return action == FindingAction::stop ? 0.9 : 0.5;
    }

    FindingActions() noexcept { actions_.fill(FindingAction::report); }

    /// From "cause=action" each. Throws InputError, naming `option`, for causes and actions that there are
    /// not, and for actions that make no sense for a cause: nothing can be learned anew of a contact, which
    /// ends, or of a frozen sensor, and only of a bias it is known what to compensate.
    FindingActions(const std::vector<std::string>& choices, const std::string& option);

    FindingAction of(Cause cause) const noexcept { return actions_[static_cast<std::size_t>(cause)]; }

    /// Whether any cause has another action than `report`.
    bool any() const noexcept;

  private:
    std::array<FindingAction, cause_count> actions_{};
};

/// An action that a loop has taken.
struct TakenAction {
    double time_s = 0; ///< since it began to move
    Cause cause = Cause::unknown;
    int joint = -1; ///< from 0; -1: none in particular
    FindingAction action = FindingAction::report;
};

} // namespace dfdyn::tools
