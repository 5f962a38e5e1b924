// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/catch.hpp"

#include <sys/wait.h>
#include <unistd.h>

namespace dfdyn::tests {

/// Runs `work` in a child process and returns its waitpid status. Exit status 99 means an exception.
template <typename Work>
int status_of_child(Work work) {
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        try {
            ::_exit(work());
        } catch (...) {
            ::_exit(99);
        }
    }
    int status = 0;
    REQUIRE(::waitpid(child, &status, 0) == child);
    return status;
}

} // namespace dfdyn::tests
