// SPDX-License-Identifier: Apache-2.0
#include "tests/tools/commands/run_program.hpp"

#include <cstdlib>
#include <sys/wait.h>

namespace dfdyn::tests {

Outcome run_program(const TemporaryDirectory& directory, const std::string& arguments,
                    const std::filesystem::path& working) {
    const std::string out = directory.path() / "stdout";
    const std::string error = directory.path() / "stderr";
    const std::string command = (working.empty() ? "" : "cd " + working.string() + " && ") + DFDYN_PROGRAM +
                                " " + arguments + " >" + out + " 2>" + error;
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, file_content(out), file_content(error)};
}

} // namespace dfdyn::tests
