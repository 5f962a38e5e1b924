// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/setup_options.hpp"

#include "tools/base/text/text.hpp"

#include <iostream>

namespace dfdyn::tools {

void SetupOptions::add_to(CLI::App& command) {
    command.add_flag("--no-setup-check", unchecked,
                     "Go on although units, clock, columns or signs of a recording look wrong");
}

bool SetupOptions::accept(const std::vector<Recording>& recordings, const SetupQuestion& question) const {
    bool accepted = true;
    for (const Recording& recording : recordings) {
        if (unchecked) {
            break;
        }
        for (const SetupFinding& finding : check_setup(recording, question)) {
            const bool mistake = finding.severity == Severity::mistake;
            std::cerr << (mistake ? "dfdyn: " : "warning: ") << shown(recording.source) << ": "
                      << finding.text << (mistake ? " (--no-setup-check goes on all the same)\n" : "\n");
            accepted = accepted && !mistake;
        }
    }
    return accepted;
}

} // namespace dfdyn::tools
