// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/atomic_file.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/tools/base/system/pipe.hpp"
#include "tools/base/text/error.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <locale>
#include <memory>
#include <ostream>
#include <stdexcept>
#include <string>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

namespace {

using dfdyn::tests::file_content;
using dfdyn::tests::Pipe;
using dfdyn::tests::status_of_child;
using dfdyn::tests::TemporaryDirectory;
using dfdyn::tools::AtomicFile;
using dfdyn::tools::GrowingFile;
using dfdyn::tools::InputError;
using dfdyn::tools::write_file;

void write_half(AtomicFile& file) { file.stream() << "half of " << std::flush; }

} // namespace

TEST_CASE("write_file writes all bytes and leaves no other file") {
    const TemporaryDirectory directory;
    const std::filesystem::path target = directory.path() / "out";
    const std::string content = std::string("a\0\r\n", 4) + std::string(1'000'000, 'x');
    write_file(target, "before");
    write_file(target, content);
    CHECK(file_content(target) == content);
    write_file(target, "");
    CHECK(file_content(target).empty());
    CHECK(directory.file_count() == 1);
}

TEST_CASE("AtomicFile shows its target only after commit") {
    const TemporaryDirectory directory;
    const std::filesystem::path target = directory.write("out", "before");
    AtomicFile file(target);
    file.stream() << "after " << 1.5 << '\n' << std::flush;
    CHECK(file_content(target) == "before");
    CHECK(directory.file_count() == 2);
    file.commit();
    CHECK(file_content(target) == "after 1.5\n");
    CHECK(directory.file_count() == 1);
}

TEST_CASE("AtomicFile without commit changes nothing") {
    const TemporaryDirectory directory;
    const std::filesystem::path target = directory.write("out", "before");
    const auto interrupted = [&] {
        AtomicFile file(target);
        write_half(file);
        throw std::runtime_error("the work failed");
    };
    CHECK_THROWS_AS(interrupted(), std::runtime_error);
    CHECK(file_content(target) == "before");
    CHECK(directory.file_count() == 1);
}

TEST_CASE("AtomicFile lets two writers of one target finish and the last one wins") {
    const TemporaryDirectory directory;
    const std::filesystem::path target = directory.path() / "out";
    AtomicFile first(target);
    AtomicFile second(target);
    first.stream() << "first";
    second.stream() << "second";
    second.commit();
    CHECK(file_content(target) == "second");
    first.commit();
    CHECK(file_content(target) == "first");
    CHECK(directory.file_count() == 1);
}

TEST_CASE("a committed AtomicFile does not remove a new temporary file of the same name") {
    const TemporaryDirectory directory;
    const std::filesystem::path target = directory.path() / "out";
    auto first = std::make_unique<AtomicFile>(target);
    first->commit();
    AtomicFile second(target);
    first.reset();
    second.stream() << "second";
    second.commit();
    CHECK(file_content(target) == "second");
}

TEST_CASE("AtomicFile writes numbers the same way in every locale") {
    struct Comma : std::numpunct<char> {
        char do_decimal_point() const override { return ','; }
    };
    const TemporaryDirectory directory;
    const std::locale previous = std::locale::global(std::locale(std::locale::classic(), new Comma));
    AtomicFile file(directory.path() / "out");
    std::locale::global(previous);
    file.stream() << 1.5;
    file.commit();
    CHECK(file_content(directory.path() / "out") == "1.5");
}

TEST_CASE("AtomicFile removes its temporary file when a signal ends the program") {
    const int signal_number = GENERATE(SIGINT, SIGTERM, SIGHUP, SIGPIPE);
    CAPTURE(signal_number);
    const TemporaryDirectory directory;
    const std::filesystem::path target = directory.write("out", "before");
    const int status = status_of_child([&] {
        std::signal(signal_number, SIG_DFL); // Catch2 has its own handler
        AtomicFile file(target);
        AtomicFile other(directory.path() / "other");
        write_half(file);
        write_half(other);
        std::raise(signal_number);
        return 0;
    });
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == signal_number);
    CHECK(file_content(target) == "before");
    CHECK(directory.file_count() == 1);
}

TEST_CASE("AtomicFile does not change signals that the program ignores or handles") {
    const TemporaryDirectory directory;
    const std::filesystem::path target = directory.path() / "out";
    const int status = status_of_child([&] {
        std::signal(SIGHUP, SIG_IGN);
        static volatile std::sig_atomic_t caught = 0;
        std::signal(SIGINT, [](int) { caught = 1; });
        AtomicFile file(target);
        file.stream() << "whole";
        std::raise(SIGHUP);
        std::raise(SIGINT);
        file.commit();
        return caught == 1 ? 0 : 1;
    });
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
    CHECK(file_content(target) == "whole");
}

TEST_CASE("a signal after the commit removes nothing") {
    const TemporaryDirectory directory;
    const std::filesystem::path target = directory.path() / "out";
    const int status = status_of_child([&] {
        std::signal(SIGTERM, SIG_DFL);
        AtomicFile file(target);
        file.stream() << "whole";
        file.commit();
        std::raise(SIGTERM);
        return 0;
    });
    CHECK(WIFSIGNALED(status));
    CHECK(file_content(target) == "whole");
    CHECK(directory.file_count() == 1);
}

TEST_CASE("AtomicFile keeps the permissions of an existing file and obeys the umask for a new one") {
    const TemporaryDirectory directory;
    const std::filesystem::path target = directory.write("out", "before");
    REQUIRE(::chmod(target.c_str(), 0640) == 0);
    write_file(target, "after");
    struct stat status {};
    REQUIRE(::stat(target.c_str(), &status) == 0);
    CHECK((status.st_mode & 07777U) == 0640U);

    const mode_t previous = ::umask(027);
    write_file(directory.path() / "new", "x");
    ::umask(previous);
    REQUIRE(::stat((directory.path() / "new").c_str(), &status) == 0);
    CHECK((status.st_mode & 07777U) == 0640U);
}

TEST_CASE("AtomicFile writes through symbolic links even if their target does not exist yet") {
    const TemporaryDirectory directory;
    const std::filesystem::path target = directory.path() / "target";
    const std::filesystem::path link = directory.path() / "link";
    std::filesystem::create_symlink("target", link);
    for (const std::string content : {"new", "replaced"}) {
        write_file(link, content);
        CHECK(std::filesystem::is_symlink(link));
        CHECK(file_content(target) == content);
    }
    CHECK(directory.file_count() == 2);
}

TEST_CASE("AtomicFile writes a pipe directly") {
    Pipe pipe;
    write_file(pipe.writing_end(), "through");
    pipe.close_writing_end();
    CHECK(pipe.read_some() == "through");
}

TEST_CASE("AtomicFile writes all bytes however many signals interrupt it") {
    struct sigaction interrupting {};
    struct sigaction previous {};
    interrupting.sa_handler = [](int) {}; // without SA_RESTART a write returns early, after a part or nothing
    REQUIRE(::sigaction(SIGUSR1, &interrupting, &previous) == 0);
    Pipe pipe;
    std::string received;
    std::thread slow_reader([&pipe, &received, writer = ::pthread_self()] {
        for (std::string part = "begin"; !part.empty();) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            ::pthread_kill(writer, SIGUSR1);
            part = pipe.read_some();
            received += part;
        }
    });
    std::string content;
    while (content.size() < 500'000) {
        content += std::to_string(content.size()) + '\n';
    }
    write_file(pipe.writing_end(), content);
    pipe.close_writing_end();
    slow_reader.join();
    REQUIRE(::sigaction(SIGUSR1, &previous, nullptr) == 0);
    CHECK(received == content);
}

TEST_CASE("GrowingFile replaces its target and shows data as soon as they are flushed") {
    const TemporaryDirectory directory;
    const auto target = directory.write("out.csv", "what was there before, and is longer");
    {
        GrowingFile file(target);
        file.stream() << "t,q\n" << 0.5;
        CHECK(file_content(target).empty());
        file.stream().flush();
        CHECK(file_content(target) == "t,q\n0.5");
        file.stream() << ",1\n";
    }
    CHECK(file_content(target) == "t,q\n0.5,1\n");
    CHECK_THROWS_AS(GrowingFile(directory.path()), InputError);
}

TEST_CASE("make_folder creates missing folders and keeps existing ones") {
    const TemporaryDirectory directory;
    const std::filesystem::path folder = directory.path() / "a/b/c";
    dfdyn::tools::make_folder(folder);
    CHECK(std::filesystem::is_directory(folder));
    CHECK_NOTHROW(dfdyn::tools::make_folder(folder));
    directory.write("file", "");
    CHECK_THROWS_AS(dfdyn::tools::make_folder(directory.path() / "file/a"), InputError);
}
