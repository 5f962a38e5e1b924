// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/usage_error.hpp"

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

} // namespace

std::string usage_message(const CLI::App& app, const CLI::ParseError& failure) {
    const std::vector<CLI::App*> chosen = app.get_subcommands();
    const std::vector<std::string> unknown = app.remaining(true);
    if (chosen.empty()) {
        const std::vector<std::string> names = subcommand_names(app);
        if (unknown.empty()) {
            return "expected a subcommand, one of " + listed(names) + ", found none (dfdyn --help)";
        }
        return "expected a subcommand, one of " + listed(names) + ", found " + in_quotes(unknown.front()) +
               suggestion(unknown.front(), names) + " (dfdyn --help)";
    }
    const CLI::App& command = *chosen.front();
    const std::string help = " (dfdyn " + command.get_name() + " --help)";
    const auto option =
        std::ranges::find_if(unknown, [](const std::string& argument) { return argument.starts_with("--"); });
    if (option == unknown.end()) {
        return std::string(failure.what()) + help;
    }
    const std::string name = option->substr(0, option->find('='));
    return "expected an option of " + command.get_name() + ", found " + in_quotes(name) +
           suggestion(name, option_names(command)) + help;
}

} // namespace dfdyn::tools
