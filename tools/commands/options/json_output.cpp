// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/json_output.hpp"

#include <iostream>

namespace dfdyn::tools {

void add_json_option(CLI::App& command, bool& chosen) {
    command.add_flag("--json", chosen, "Print the figures as JSON instead of text");
}

JsonOutput::JsonOutput(bool chosen) : output_(chosen ? std::cout.rdbuf(&sink_) : nullptr) {}

JsonOutput::~JsonOutput() {
    if (output_ != nullptr) {
        std::cout.rdbuf(output_);
    }
}

void JsonOutput::print(const nlohmann::ordered_json& figures) const {
    if (output_ != nullptr) {
        std::ostream(output_) << figures.dump(2) << '\n' << std::flush;
    }
}

} // namespace dfdyn::tools
