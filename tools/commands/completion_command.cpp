// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/command.hpp"
#include "tools/commands/manual/man_page.hpp"
#include "tools/commands/options/value_checks.hpp"

#include <iostream>
#include <memory>

namespace dfdyn::tools {

void add_completion_command(CLI::App& app, Command& chosen) {
    const auto shell = std::make_shared<std::string>();
    CLI::App* command =
        app.add_subcommand("completion", "Prints a script that completes the command line of a shell");
    command->add_option("SHELL", *shell, "Shell")->required()->check(one_of({"bash"}));
    command->footer("Example:\n  source <(dfdyn completion bash)\nExit status: 0 done, 2 bad usage.");
    command->callback([shell, &app, &chosen] {
        chosen = [shell, &app] {
            std::cout << bash_completion(app);
            return 0;
        };
    });
}

} // namespace dfdyn::tools
