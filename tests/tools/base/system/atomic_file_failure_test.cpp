// SPDX-License-Identifier: Apache-2.0
// Files that cannot be written: what is reported, and that the earlier file remains.
#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/tools/base/system/pipe.hpp"
#include "tools/base/system/atomic_file.hpp"
#include "tools/base/text/error.hpp"

#include <csignal>
#include <ostream>
#include <string>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace atomic_file_failure_test {

using namespace dfdyn::tests;
using namespace dfdyn::tools;

TEST_CASE("AtomicFile reports a full disk when writing and keeps the target") {
    const TemporaryDirectory directory;
    const std::filesystem::path target = directory.write("out", "before");
    const int status = status_of_child([&] {
        const rlimit limit{100'000, 100'000};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        AtomicFile file(target);
        std::size_t written = 0;
        try {
            for (; written < 1'000'000; written += 10) {
                file.stream() << "ten bytes\n";
            }
        } catch (const InputError& error) {
            const bool named = error.what() == target.string() + ": cannot write: File too large";
            return named && written < 200'000 ? 0 : 1;
        }
        return 2;
    });
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
    CHECK(file_content(target) == "before");
    CHECK(directory.file_count() == 1);
}

TEST_CASE("AtomicFile does not commit if a write failed") {
    // A pipe that nobody reads, instead of a device like /dev/full, which a faulty build run as root would
    // replace.
    Pipe pipe;
    const std::string target = pipe.writing_end();
    AtomicFile flushed(target);
    AtomicFile committed(target);
    pipe.close_reading_end();
    const auto previous = std::signal(SIGPIPE, SIG_IGN);
    flushed.stream() << 1.5; // stays in the buffer
    committed.stream() << 1.5;
    CHECK_THROWS_MATCHES(flushed.stream().flush(), InputError,
                         Catch::Matchers::Message(target + ": cannot write: Broken pipe"));
    CHECK_THROWS_MATCHES(flushed.commit(), InputError,
                         Catch::Matchers::Message(target + ": cannot write: an earlier write failed"));
    CHECK_THROWS_MATCHES(committed.commit(), InputError,
                         Catch::Matchers::Message(target + ": cannot write: Broken pipe"));
    std::signal(SIGPIPE, previous);
}

TEST_CASE("AtomicFile names the path and the reason if it cannot begin") {
    const TemporaryDirectory directory;
    const std::string base = directory.path().string();
    CHECK_THROWS_MATCHES(write_file(base + "/none/out", "x"), InputError,
                         Catch::Matchers::Message(base + "/none/out: expected an existing folder " + base +
                                                  "/none, found none"));
    CHECK_THROWS_MATCHES(write_file(base, "x"), InputError,
                         Catch::Matchers::Message(base + ": cannot write: Is a directory"));
    const std::string long_name = base + "/" + std::string(300, 'x');
    CHECK_THROWS_MATCHES(
        write_file(long_name, "x"), InputError,
        Catch::Matchers::Message(long_name + ": cannot create a file beside it: File name too long"));
    std::string deep = base;
    while (deep.size() < 5000) {
        deep += "/" + std::string(200, 'x');
    }
    CHECK_THROWS_MATCHES(
        write_file(deep, "x"), InputError,
        Catch::Matchers::Message(deep + ": cannot create a file beside it: File name too long"));
    CHECK(directory.file_count() == 0);
}

TEST_CASE("AtomicFile reports a target that has become a directory") {
    const TemporaryDirectory directory;
    const std::string target = directory.path() / "out";
    {
        AtomicFile file(target);
        file.stream() << "whole";
        std::filesystem::create_directory(target);
        CHECK_THROWS_MATCHES(file.commit(), InputError,
                             Catch::Matchers::Message(target + ": cannot replace: Is a directory"));
    }
    CHECK(directory.file_count() == 1);
}

TEST_CASE("AtomicFile does not replace a file that its user may not write") {
    const TemporaryDirectory directory;
    const std::filesystem::path target = directory.write("out", "before");
    REQUIRE(::chmod(target.c_str(), 0444) == 0);
    REQUIRE(::chmod(directory.path().c_str(), 0777) == 0);
    const int status = status_of_child([&] {
        constexpr uid_t nobody = 65534; // because root may write everything
        if (::geteuid() == 0 && ::seteuid(nobody) != 0) {
            return 2;
        }
        try {
            write_file(target, "after");
        } catch (const InputError& error) {
            return error.what() == target.string() + ": cannot write: Permission denied" ? 0 : 1;
        }
        return 3;
    });
    CHECK(WEXITSTATUS(status) == 0);
    CHECK(file_content(target) == "before");
    CHECK(directory.file_count() == 1);
}

} // namespace atomic_file_failure_test
