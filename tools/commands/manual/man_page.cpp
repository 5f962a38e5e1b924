// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/manual/man_page.hpp"

#include <algorithm>
#include <sstream>

namespace dfdyn::tools {
namespace {

/// Returns `text` with the characters escaped that roff interprets.
std::string escaped(const std::string& text) {
    std::string safe = text.starts_with('.') || text.starts_with('\'') ? "\\&" : "";
    for (const char letter : text) {
        safe += letter == '\\' ? "\\e" : letter == '-' ? "\\-" : std::string(1, letter);
    }
    return safe;
}

std::string title(const std::string& name, const std::string& version) {
    return ".TH " + name + " 1 \"\" \"" + version + "\" \"dfdyn manual\"\n";
}

/// Returns the names of an option with its value, such as `-o, --output M.json`.
std::string heading(const CLI::Option& option) {
    std::string names;
    for (const std::string& name : option.get_snames()) {
        names.append(names.empty() ? "" : ", ").append("-" + name);
    }
    for (const std::string& name : option.get_lnames()) {
        names.append(names.empty() ? "" : ", ").append("--" + name);
    }
    if (names.empty()) {
        return escaped(option.get_name(true));
    }
    const std::string value = option.get_items_expected_max() > 0 ? " " + option.get_type_name() : "";
    return "\\fB" + escaped(names) + "\\fR" + escaped(value);
}

std::string option_list(const CLI::App& command) {
    std::string text = ".SH OPTIONS\n";
    for (const CLI::Option* const option : command.get_options()) {
        text += ".TP\n" + heading(*option) + "\n" + escaped(option->get_description());
        text +=
            option->get_default_str().empty() ? "" : " (default: " + escaped(option->get_default_str()) + ")";
        text += option->get_required() ? " (required)\n" : "\n";
    }
    return text;
}

/// Returns the footer of a help text as sections: examples, which are indented, notes, and the exit status.
std::string footer_sections(const std::string& footer) {
    const std::string exit = "Exit status: ";
    std::istringstream lines(footer);
    std::string examples, notes, status;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("  ")) {
            examples += escaped(line) + "\n";
        } else if (line.starts_with(exit)) {
            status = escaped(line.substr(exit.size())) + "\n";
        } else if (!line.starts_with("Example")) {
            notes += escaped(line) + "\n";
        }
    }
    return (notes.empty() ? "" : ".SH NOTES\n" + notes) +
           (examples.empty() ? "" : ".SH EXAMPLES\n.nf\n" + examples + ".fi\n") +
           (status.empty() ? "" : ".SH EXIT STATUS\n" + status);
}

std::string program_page(const CLI::App& program, const std::string& version) {
    std::string text = title("dfdyn", version) + ".SH NAME\ndfdyn \\- " + escaped(program.get_description()) +
                       "\n.SH SYNOPSIS\n\\fBdfdyn\\fR SUBCOMMAND [OPTIONS]\n.SH SUBCOMMANDS\n";
    for (const CLI::App* const command : subcommands(program)) {
        text += ".TP\n\\fB" + command->get_name() + "\\fR\n" + escaped(command->get_description()) +
                ": \\fBdfdyn\\-" + command->get_name() + "\\fR(1)\n";
    }
    return text + option_list(program) +
           ".SH EXIT STATUS\n0 done, 1 the work was done and its answer is negative, 2 bad usage or input, 3 "
           "internal error.\n";
}

/// Returns the names that an option accepts, such as `{NP,P}` or `tau|i`; empty: it accepts other values.
std::string named_values(const CLI::Option& option) {
    const std::string type = option.get_type_name();
    const std::size_t from = type.find('{');
    std::string names;
    if (from != std::string::npos) {
        names = type.substr(from + 1, type.find('}', from) - from - 1);
    } else if (type.find('|') != std::string::npos && type.find_first_of("[*=.") == std::string::npos) {
        names = type;
    }
    std::ranges::replace_if(
        names, [](char letter) { return letter == ',' || letter == '|'; }, ' ');
    return names;
}

/// Names of subcommands, and lines of the cases for options and for their values.
struct CompletionWords {
    std::string names = "--help --version", options, values;
};

CompletionWords completion_words(const CLI::App& program) {
    CompletionWords words;
    auto& [names, options, values] = words;
    for (const CLI::App* const command : subcommands(program)) {
        names += " " + command->get_name();
        options += "    " + command->get_name() + ") words=\"";
        for (const CLI::Option* const option : command->get_options()) {
            const std::string accepted = named_values(*option);
            for (const std::string& name : option->get_lnames()) {
                options += "--" + name + " ";
                if (!accepted.empty()) {
                    values +=
                        "    " + command->get_name() + ":--" + name + ") words=\"" + accepted + "\" ;;\n";
                }
            }
        }
        options += "\" ;;\n";
    }
    return words;
}

} // namespace

std::vector<const CLI::App*> subcommands(const CLI::App& program) {
    return program.get_subcommands([](const CLI::App*) { return true; });
}

std::string man_page(const CLI::App& program, const CLI::App* command, const std::string& version) {
    if (command == nullptr) {
        return program_page(program, version);
    }
    const std::string name = command->get_name();
    return title("dfdyn-" + name, version) + ".SH NAME\ndfdyn\\-" + name + " \\- " +
           escaped(command->get_description()) + "\n.SH SYNOPSIS\n\\fBdfdyn " + name + "\\fR [OPTIONS]\n" +
           option_list(*command) + footer_sections(command->get_footer()) +
           ".SH SEE ALSO\n\\fBdfdyn\\fR(1)\n";
}

std::string bash_completion(const CLI::App& program) {
    const auto [names, options, values] = completion_words(program);
    return "# bash completion for dfdyn, written by `dfdyn completion bash`\n"
           "_dfdyn() {\n"
           "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} words=\"\"\n"
           "    COMPREPLY=()\n"
           "    if [[ $COMP_CWORD -eq 1 ]]; then\n"
           "        mapfile -t COMPREPLY < <(compgen -W \"" +
           names +
           "\" -- \"$current\")\n"
           "        return\n"
           "    fi\n"
           "    case ${COMP_WORDS[1]}:$previous in\n" +
           values +
           "    esac\n"
           "    if [[ -z $words && $current == -* ]]; then\n"
           "    case ${COMP_WORDS[1]} in\n" +
           options +
           "    esac\n"
           "    fi\n"
           "    if [[ -n $words ]]; then\n"
           "        mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n"
           "    else\n"
           "        mapfile -t COMPREPLY < <(compgen -f -- \"$current\")\n"
           "    fi\n"
           "}\n"
           "complete -o filenames -F _dfdyn dfdyn\n";
}

} // namespace dfdyn::tools
