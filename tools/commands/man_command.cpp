// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/atomic_file.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/text.hpp"
#include "tools/build_flags.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/manual/man_page.hpp"

#include <iostream>
#include <memory>
#include <vector>

namespace dfdyn::tools {
namespace {

struct ManOptions {
    std::string page;
    std::filesystem::path folder;
};

/// Returns the name and version of the program, without the compiler's flags.
std::string program_version() {
    const std::string flags = build_flags();
    return flags.substr(0, flags.find_first_of(",;(\n", flags.find(' ')));
}

void write_pages(const CLI::App& program, const std::filesystem::path& folder) {
    make_folder(folder);
    write_file(folder / "dfdyn.1", man_page(program, nullptr, program_version()));
    for (const CLI::App* const command : subcommands(program)) {
        write_file(folder / ("dfdyn-" + command->get_name() + ".1"),
                   man_page(program, command, program_version()));
    }
}

int run(const CLI::App& program, const ManOptions& options) {
    if (!options.folder.empty()) {
        write_pages(program, options.folder);
        return 0;
    }
    std::vector<std::string> names;
    for (const CLI::App* const command : subcommands(program)) {
        names.push_back(command->get_name());
        if (names.back() == options.page) {
            std::cout << man_page(program, command, program_version());
            return 0;
        }
    }
    if (!options.page.empty()) {
        throw InputError("man: expected a subcommand, one of " + listed(names) + ", found " +
                         in_quotes(options.page) + suggestion(options.page, names));
    }
    std::cout << man_page(program, nullptr, program_version());
    return 0;
}

} // namespace

void add_man_command(CLI::App& app, Command& chosen) {
    const auto options = std::make_shared<ManOptions>();
    CLI::App* command = app.add_subcommand("man", "Prints the manual page of the program or of a subcommand");
    command->add_option("PAGE", options->page, "Subcommand; default: the program");
    command->add_option("-o,--output", options->folder, "Writes all pages into this folder instead")
        ->type_name("DIR");
    command->footer("Example:\n  dfdyn man train | man -l -\nExit status: 0 done, 2 bad usage.");
    command->callback([options, &app, &chosen] { chosen = [options, &app] { return run(app, *options); }; });
}

} // namespace dfdyn::tools
