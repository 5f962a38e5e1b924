// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/usage_error.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/text.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
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

std::string help_of(const CLI::App& command) { return " (dfdyn " + command.get_name() + " --help)"; }

/// Returns the option that an argument names without a value; null if it names none.
const CLI::Option* option_at(const CLI::App& command, const std::string& argument) {
    return argument.starts_with('-') && argument.size() > 1 ? command.get_option_no_throw(argument) : nullptr;
}

/// Endings of files by which an option is recognised; an ending such as `.log` fits several.
bool tells_option(const std::string& ending) {
    constexpr std::array<std::string_view, 6> endings{".csv", ".json", ".hpp", ".html", ".urdf", ".mcap"};
    return std::ranges::find(endings, ending) != endings.end();
}

/// Returns whether the option names files with this ending, such as `--log L.csv`.
bool takes_files(const CLI::Option& option, const std::string& ending) {
    const std::string type = option.get_type_name();
    return type.find(ending) != std::string::npos || (ending == ".mcap" && option.get_name() == "--log");
}

/// Returns whether the option names a file to write. Its ending is the user's choice.
bool writes_file(const CLI::Option& option) {
    constexpr std::array<std::string_view, 8> names{"--output",  "--header",       "--report",  "--record",
                                                    "--changes", "--contact-list", "--candump", "--truth"};
    return std::ranges::any_of(
        names, [&](std::string_view name) { return option.check_lname(std::string(name.substr(2))); });
}

/// Returns the first option that names files with the ending of `argument`, inputs before outputs; null if
/// there is none.
const CLI::Option* option_of_file(const CLI::App& command, const std::string& argument) {
    const std::string ending = std::filesystem::path(argument).extension().string();
    if (!tells_option(ending)) {
        return nullptr;
    }
    std::vector<const CLI::Option*> options = command.get_options();
    std::stable_partition(options.begin(), options.end(),
                          [](const CLI::Option* option) { return !writes_file(*option); });
    const auto found = std::ranges::find_if(
        options, [&](const CLI::Option* option) { return takes_files(*option, ending); });
    return found == options.end() ? nullptr : *found;
}

/// Refuses an existing file that the option would read, but that another option reads by its ending.
void refuse_file_of_other_option(const CLI::App& command, const CLI::Option& option) {
    const bool reads_files = option.get_type_name().find('.') != std::string::npos && !writes_file(option);
    for (const std::string& value : option.results()) {
        const CLI::Option* const other = option_of_file(command, value);
        std::error_code ignored;
        if (reads_files && other != nullptr && !writes_file(*other) &&
            std::filesystem::exists(value, ignored) &&
            !takes_files(option, std::filesystem::path(value).extension().string())) {
            throw InputError(with_value(option) + ": expected a file of that kind, found " +
                             shown(std::filesystem::path(value)) + ", which fits " + with_value(*other) +
                             help_of(command));
        }
    }
}

/// Returns a hint for an argument without an option.
std::string option_hint(const CLI::App& command, const std::string& argument) {
    if (const CLI::Option* const option = option_of_file(command, argument)) {
        return " (did you mean " + option->get_name() + " " + shown(std::filesystem::path(argument)) + "?)";
    }
    const bool file = argument.find_first_of("./") != std::string::npos;
    return file ? "" : suggestion(argument, option_names(command));
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
    const std::string help = help_of(command);
    if (unknown.empty()) {
        return option_message(command, failure) + help;
    }
    const auto option =
        std::ranges::find_if(unknown, [](const std::string& argument) { return argument.starts_with('-'); });
    const std::string& argument = option == unknown.end() ? unknown.front() : *option;
    const std::string name = argument.substr(0, argument.find('='));
    return "expected an option of " + command.get_name() + ", found " + in_quotes(name) +
           option_hint(command, name) + help;
}

void refuse_missing_values(const CLI::App& app, std::span<char* const> arguments) {
    const CLI::App* command = nullptr;
    for (std::size_t i = 1; i < arguments.size(); ++i) {
        const std::string argument = arguments[i];
        if (command == nullptr) {
            const auto named =
                app.get_subcommands([&](const CLI::App* one) { return one->check_name(argument); });
            command = named.empty() ? nullptr : named.front();
            continue;
        }
        if (argument.ends_with('=')) { // CLI11 would take the next argument as the value
            const CLI::Option* const empty = option_at(*command, argument.substr(0, argument.size() - 1));
            if (empty != nullptr) {
                throw InputError(with_value(*empty) + ": expected a value, found an empty one");
            }
        }
        const CLI::Option* const option = option_at(*command, argument);
        if (option != nullptr && i + 1 < arguments.size() && option->get_items_expected_min() > 0 &&
            option_at(*command, arguments[i + 1]) != nullptr) {
            throw InputError(with_value(*option) + ": expected a value, found the option " +
                             in_quotes(arguments[i + 1]) + help_of(*command));
        }
    }
}

void refuse_wrong_values(const CLI::App& app) {
    for (const CLI::App* const command : app.get_subcommands()) {
        for (const CLI::Option* const option : command->get_options()) {
            if (option->count() > 0 && std::ranges::any_of(option->results(), &std::string::empty)) {
                throw InputError(with_value(*option) + ": expected a value, found an empty one");
            }
        }
        for (const CLI::Option* const option : command->get_options()) {
            if (option->count() > 0) {
                refuse_file_of_other_option(*command, *option);
            }
        }
    }
}

} // namespace dfdyn::tools
