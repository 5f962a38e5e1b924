// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/commands/program.hpp"

#include <exception>
#include <filesystem>
#include <iostream>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

/// Keeps freed memory instead of returning it to the system at once. Training allocates and frees matrices of
/// megabytes for each evaluation; by default glibc maps and unmaps them, and the page faults of the next use
/// take 40 % of the time. 32 MiB is the largest threshold that glibc accepts.
void keep_freed_memory() {
#ifdef __GLIBC__
    constexpr int largest_on_heap = 32 << 20;
    constexpr int kept_on_top = 1 << 30;
    ::mallopt(M_MMAP_THRESHOLD, largest_on_heap);
    ::mallopt(M_TRIM_THRESHOLD, kept_on_top);
#endif
}

} // namespace

/// Exit status: 0 success, 1 the work was done and its result is negative, 2 wrong usage or input, 3 an
/// internal error of the program.
int main(int argc, char** argv) {
    keep_freed_memory();
    try {
        return dfdyn::tools::run_program(argc, argv);
    } catch (const dfdyn::tools::InputError& error) {
        std::cerr << "dfdyn: " << error.what() << '\n';
        return 2;
    } catch (const std::filesystem::filesystem_error& error) { // a name that the system refuses
        std::cerr << "dfdyn: " << dfdyn::tools::shown(error.path1())
                  << ": cannot be used: " << error.code().message() << '\n';
        return 2;
    } catch (const std::exception& error) {
        std::cerr << "dfdyn: internal error: " << error.what() << '\n';
        return 3;
    }
}
