// SPDX-License-Identifier: Apache-2.0
#include "tools/commands/options/json_output.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/json_text.hpp"

#include <cerrno>
#include <iostream>
#include <string>
#include <system_error>

namespace dfdyn::tools {

void add_json_option(CLI::App& command, bool& chosen) {
    command.add_flag("--json", chosen, "Print the figures as JSON instead of text");
}

void flush_standard_output(std::ostream& output) {
    errno = 0;
    if (!output.flush()) {
        throw InputError(std::string("cannot write to standard output: ") +
                         (errno == 0 ? "an earlier write failed"
                                     : std::error_code(errno, std::generic_category()).message()));
    }
}

JsonOutput::JsonOutput(bool chosen) : output_(chosen ? std::cout.rdbuf(&sink_) : nullptr) {}

JsonOutput::~JsonOutput() {
    if (output_ != nullptr) {
        std::cout.rdbuf(output_);
    }
}

void JsonOutput::print(const nlohmann::ordered_json& figures) const {
    if (output_ != nullptr) {
        std::ostream output(output_);
        output << json_text(figures) << '\n';
        flush_standard_output(output);
    }
}

} // namespace dfdyn::tools
