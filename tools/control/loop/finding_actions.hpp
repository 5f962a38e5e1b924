// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/monitor/cause.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// Reaction of a loop to a change that the learner's monitor has identified, or to a contact.
enum class FindingAction : std::uint8_t {
    report,     ///< no reaction: the change appears in the report
    relearn,    ///< resets the learner's covariance to the prior, so that it adapts quickly
    compensate, ///< adds the estimated offset to the nominal torque
    stop,       ///< stops the loop, see StopCause::finding
    hold,       ///< of a contact: stops on the path and stays there, with gravity torque and feedback
    yield,      ///< of a contact: gravity torque alone; holds the arm at its position after it
};

const char* name(FindingAction action) noexcept;

/// Returns the reaction to a contact with this name: stop, hold or yield. Throws InputError, naming `option`,
/// for any other text.
FindingAction contact_action(const std::string& text, const std::string& option);

/// One action for each cause; the default is `report`.
class FindingActions {
  public:
    /// Minimum confidence for a reaction. Below it the loop continues, and feedback and learner correct the
    /// error.
    static constexpr double least_confidence(FindingAction action) noexcept {
        return action == FindingAction::stop ? 0.9 : 0.5;
    }

    FindingActions() noexcept { actions_.fill(FindingAction::report); }

    /// Parses items "cause=action". Throws InputError, naming `option`, for unknown causes and actions, and
    /// for unsuitable actions: relearning is useless for a temporary contact and for a frozen sensor; only a
    /// bias can be compensated.
    FindingActions(const std::vector<std::string>& choices, const std::string& option);

    FindingAction of(Cause cause) const noexcept { return actions_[static_cast<std::size_t>(cause)]; }

    /// Returns whether any cause has an action other than `report`.
    bool any() const noexcept;

  private:
    std::array<FindingAction, cause_count> actions_{};
};

/// A reaction of a loop.
struct TakenAction {
    double time_s = 0; ///< since the beginning of the motion
    Cause cause = Cause::unknown;
    int joint = -1; ///< from 0; -1: no particular joint
    FindingAction action = FindingAction::report;
};

/// Reactions of a loop: the first 64, and the one that stops it.
class TakenActions {
  public:
    TakenActions() { taken_.reserve(most + 1); }

    void add(const TakenAction& action);

    const std::vector<TakenAction>& list() const noexcept { return taken_; }
    /// Returns the first reaction that stops the loop; empty: none.
    const std::optional<TakenAction>& stop() const noexcept { return stop_; }

  private:
    static constexpr std::size_t most = 64;

    std::vector<TakenAction> taken_;
    std::optional<TakenAction> stop_;
};

} // namespace dfdyn::tools
