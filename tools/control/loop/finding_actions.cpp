// SPDX-License-Identifier: Apache-2.0
#include "tools/control/loop/finding_actions.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

constexpr std::array all_actions{FindingAction::report, FindingAction::relearn, FindingAction::compensate,
                                 FindingAction::stop};

bool makes_sense(Cause cause, FindingAction action) {
    switch (action) {
    case FindingAction::relearn:
        return cause != Cause::contact && cause != Cause::frozen;
    case FindingAction::compensate:
        return cause == Cause::bias;
    default:
        return true;
    }
}

std::vector<std::string> causes() {
    std::vector<std::string> names;
    for (int cause = 0; cause < cause_count; ++cause) {
        names.emplace_back(dfdyn::name(static_cast<Cause>(cause)));
    }
    return names;
}

std::string actions_of(Cause cause) {
    std::vector<std::string> names;
    for (const FindingAction action : all_actions) {
        if (makes_sense(cause, action)) {
            names.emplace_back(name(action));
        }
    }
    return listed(names);
}

Cause cause_named(const std::string& text, const std::string& option) {
    for (int cause = 0; cause < cause_count; ++cause) {
        if (text == dfdyn::name(static_cast<Cause>(cause))) {
            return static_cast<Cause>(cause);
        }
    }
    throw InputError(option + ": expected CAUSE=ACTION with one of the causes " + listed(causes()) +
                     ", found " + in_quotes(text) + suggestion(text, causes()));
}

InputError no_such_action(Cause cause, const std::string& text, const std::string& option) {
    return InputError(option + ": " + dfdyn::name(cause) + ": expected " + actions_of(cause) + ", found \"" +
                      text + "\"");
}

} // namespace

const char* name(FindingAction action) noexcept {
    switch (action) {
    case FindingAction::report:
        return "report";
    case FindingAction::relearn:
        return "relearn";
    case FindingAction::compensate:
        return "compensate";
    case FindingAction::stop:
        return "stop";
    case FindingAction::hold:
        return "hold";
    case FindingAction::yield:
        return "yield";
    }
    return "unknown";
}

FindingAction contact_action(const std::string& text, const std::string& option) {
    for (const FindingAction action : {FindingAction::stop, FindingAction::hold, FindingAction::yield}) {
        if (text == name(action)) {
            return action;
        }
    }
    throw InputError(option + ": expected stop, hold or yield, found " + in_quotes(text));
}

FindingActions::FindingActions(const std::vector<std::string>& choices, const std::string& option)
    : FindingActions() {
    for (const std::string& choice : choices) {
        const std::size_t equals = choice.find('=');
        const Cause cause = cause_named(choice.substr(0, equals), option);
        const std::string text = equals == std::string::npos ? "" : choice.substr(equals + 1);
        const auto* const action = std::ranges::find_if(
            all_actions, [&](FindingAction one) { return makes_sense(cause, one) && text == name(one); });
        if (action == all_actions.end()) {
            throw no_such_action(cause, text, option);
        }
        actions_[static_cast<std::size_t>(cause)] = *action;
    }
}

bool FindingActions::any() const noexcept {
    return std::ranges::any_of(actions_, [](FindingAction one) { return one != FindingAction::report; });
}

void TakenActions::add(const TakenAction& action) {
    const bool stops = action.action == FindingAction::stop && !stop_;
    if (stops) {
        stop_ = action;
    }
    if (taken_.size() < most || stops) {
        taken_.push_back(action);
    }
}

} // namespace dfdyn::tools
