// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/temporary_directory.hpp"

#include <string>

namespace dfdyn::tests {

/// Result of a call of the program.
struct Outcome {
    int status; ///< -1 if it did not exit by itself
    std::string out;
    std::string error;
};

/// Runs `dfdyn ARGUMENTS` as a script would, with standard output and error in files of `directory`, in the
/// folder `working`; empty: the current one.
Outcome run_program(const TemporaryDirectory& directory, const std::string& arguments,
                    const std::filesystem::path& working = {});

} // namespace dfdyn::tests
