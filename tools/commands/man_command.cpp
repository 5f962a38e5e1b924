// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/file_set.hpp"
#include "tools/base/text/error.hpp"
#include "tools/base/text/nearest_name.hpp"
#include "tools/base/text/text.hpp"
#include "tools/build_flags.hpp"
#include "tools/commands/command.hpp"
#include "tools/commands/manual/man_page.hpp"

#include <iostream>
#include <memory>
#include <utility>
#include <vector>

namespace dfdyn::tools {
namespace {

struct ManOptions {
    std::string page;
    std::filesystem::path folder;
    bool reference = false;
};

/// Returns the name and version of the program, without the compiler's flags.
std::string program_version() {
    const std::string flags = build_flags();
    return flags.substr(0, flags.find_first_of(",;(\n", flags.find(' ')));
}

void write_pages(const CLI::App& program, const std::filesystem::path& folder) {
    FileSet files;
    files.add_folder(folder);
    files.add(folder / "dfdyn.1", man_page(program, nullptr, program_version()));
    for (const CLI::App* const command : subcommands(program)) {
        files.add(folder / ("dfdyn-" + command->get_name() + ".1"),
                  man_page(program, command, program_version()));
    }
    files.commit();
}

/// Prints the help texts of all commands as docs/reference/commands.md.
void print_reference(const CLI::App& program) {
    std::cout << "# Commands\n\nThe help text of every command, printed by `dfdyn man --reference`. A test "
                 "compares them.\n"
                 "Examples of each: [the program](../guide/program.md). Exit status: "
                 "[exit-status.md](exit-status.md).\n";
    for (const CLI::App* const command : subcommands(program)) {
        std::cout << "\n## " << command->get_name() << "\n```\n" << command->help("dfdyn") << "```\n";
    }
}

int run(const CLI::App& program, const ManOptions& options) {
    std::vector<std::string> wanted;
    for (const auto& [given, name] : {std::pair{!options.page.empty(), "page " + in_quotes(options.page)},
                                      std::pair{!options.folder.empty(), std::string("-o")},
                                      std::pair{options.reference, std::string("--reference")}}) {
        if (given) {
            wanted.push_back(name);
        }
    }
    if (wanted.size() > 1) {
        throw InputError("man: expected one of a page, -o and --reference, which have all pages, found " +
                         listed(wanted));
    }
    if (options.reference) {
        print_reference(program);
        return 0;
    }
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
    command->add_flag("--reference", options->reference,
                      "Prints the help of all commands as docs/reference/commands.md");
    command->footer("Example:\n  dfdyn man train | man -l -\nExit status: 0 done, 2 bad usage.");
    command->callback([options, &app, &chosen] { chosen = [options, &app] { return run(app, *options); }; });
}

} // namespace dfdyn::tools
