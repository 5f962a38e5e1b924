// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/usage_error.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <vector>

namespace dfdyn::tools {
namespace {

std::vector<std::string> subcommand_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* const command : app.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(command->get_name());
    }
    return names;
}

std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* const option : command.get_options()) {
        for (const std::string& name : option->get_lnames()) {
            names.push_back("--" + name);
        }
    }
    return names;
}

/// Returns the options that a message of CLI11 names, in their order there.
std::vector<const CLI::Option*> named_options(const CLI::App& command, const std::string& message) {
    std::vector<const CLI::Option*> options;
    for (std::string word : CLI::detail::split(message, ' ')) {
        word.erase(std::ranges::find_if(word, [](char letter) { return letter == ':' || letter == ','; }),
                   word.end());
        const CLI::Option* const option =
            word.starts_with("--") ? command.get_option_no_throw(word) : nullptr;
        if (option != nullptr) {
            options.push_back(option);
        }
    }
    return options;
}

/// Returns an option with its value for a message, such as `--log L.csv`.
std::string with_value(const CLI::Option& option) {
    const std::string value = option.get_type_name().substr(0, option.get_type_name().find(':'));
    return option.get_name() + (value.empty() ? "" : " " + value);
}

/// Returns the message for too many or too few values of an option, which CLI11 refused with `refusal`.
std::string count_message(const CLI::Option& option, const std::string& refusal) {
    const int least = option.get_items_expected_min();
    const auto found = static_cast<int>(option.results().size());
    if (least == 0) {
        return option.get_name() + ": expected no value, found one";
    }
    if (found == 0 || refusal.ends_with(" missing")) { // earlier ones may have had values
        return with_value(option) + ": expected a value, found none";
    }
    const std::string values = listed(option.results());
    return found > least && least == 1
               ? option.get_name() + ": expected once, found " + std::to_string(found) + " times: " + values
               : with_value(option) + ": expected " + std::to_string(least) + " values, found " + values;
}

/// Returns the message for known options that are wrong, missing or contradict each other.
std::string option_message(const CLI::App& command, const CLI::ParseError& failure) {
    const std::vector<const CLI::Option*> named = named_options(command, failure.what());
    if (named.empty()) {
        const std::string what = failure.what();
        const std::string required = " is required"; // a value without an option
        return what.ends_with(required)
                   ? "expected " + what.substr(0, what.size() - required.size()) + ", found none"
                   : what;
    }
    const CLI::Option& first = *named.front();
    if (dynamic_cast<const CLI::RequiredError*>(&failure) != nullptr) {
        return "expected " + with_value(first) + ", found none";
    }
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&failure) != nullptr) {
        return count_message(first, failure.what());
    }
    if (dynamic_cast<const CLI::ConversionError*>(&failure) != nullptr) {
        return with_value(first) + ": expected another value, found " + in_quotes(listed(first.results()));
    }
    if (named.size() > 1 && dynamic_cast<const CLI::ExcludesError*>(&failure) != nullptr) {
        return "expected " + first.get_name() + " or " + named[1]->get_name() + ", found both";
    }
    if (named.size() > 1 && dynamic_cast<const CLI::RequiresError*>(&failure) != nullptr) {
        return first.get_name() + ": expected " + with_value(*named[1]) + " with it, found none";
    }
    return failure.what();
}

} // namespace

std::string usage_message(const CLI::App& app, const CLI::ParseError& failure) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    const std::vector<std::string> unknown = app.remaining(true);
    if (chosen.empty()) {
        std::vector<std::string> names = subcommand_names(app);
        const std::string expected = "expected a subcommand, one of " + listed(names) + ", found ";
        if (unknown.empty()) {
            return expected + "none (dfdyn --help)";
        }
        std::ranges::copy(option_names(app), std::back_inserter(names));
        return expected + in_quotes(unknown.front()) + suggestion(unknown.front(), names) + " (dfdyn --help)";
    }
    const CLI::App& command = *chosen.front();
    const std::string help = " (dfdyn " + command.get_name() + " --help)";
    if (unknown.empty()) {
        return option_message(command, failure) + help;
    }
    const auto option =
        std::ranges::find_if(unknown, [](const std::string& argument) { return argument.starts_with('-'); });
    const std::string& argument = option == unknown.end() ? unknown.front() : *option;
    const std::string name = argument.substr(0, argument.find('='));
    return "expected an option of " + command.get_name() + ", found " + in_quotes(name) +
           suggestion(name, option_names(command)) + help;
}

void refuse_empty_values(const CLI::App& app) {
    for (const CLI::App* const command : app.get_subcommands()) {
        for (const CLI::Option* const option : command->get_options()) {
            if (option->count() > 0 && std::ranges::any_of(option->results(), &std::string::empty)) {
                throw InputError(with_value(*option) + ": expected a value, found an empty one");
            }
        }
    }
}

} // namespace dfdyn::tools
