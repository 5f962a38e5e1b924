// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/file_set.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/base/text/error.hpp"

#include <array>
#include <chrono>
#include <csignal>
#include <map>
#include <ostream>
#include <random>
#include <string>
#include <sys/resource.h>
#include <sys/stat.h>
#include <thread>
#include <unistd.h>

namespace file_set_test {

namespace fs = std::filesystem;
using dfdyn::tests::file_content;
using dfdyn::tests::status_of_child;
using dfdyn::tests::TemporaryDirectory;
using dfdyn::tools::FileSet;
using dfdyn::tools::InputError;
using State = std::map<std::string, std::string>;

/// Returns the relative path of each file with its content, and of each folder.
State state_of(const fs::path& folder) {
    State state;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
        const std::string name = entry.path().lexically_relative(folder).string();
        state[name] = entry.is_directory() ? "folder" : file_content(entry.path());
    }
    return state;
}

/// A folder with one earlier result.
struct Results {
    TemporaryDirectory directory;
    fs::path folder = directory.path();
    Results() { directory.write("model.json", "before"); }

    State state() const { return state_of(folder); }

    /// Adds an existing file, a new one, and two files in new folders.
    void add_to(FileSet& files) const {
        files.add(folder / "model.json", "model");
        files.add(folder / "model.hpp") << "header";
        files.add_folder(folder / "new/pictures");
        files.add(folder / "new/report.html", "report");
        files.add(folder / "new/pictures/a.svg") << "picture";
    }
};

const State before{{"model.json", "before"}};
const State after{{"model.json", "model"},    {"model.hpp", "header"},
                  {"new", "folder"},          {"new/report.html", "report"},
                  {"new/pictures", "folder"}, {"new/pictures/a.svg", "picture"}};

TEST_CASE("the files of a set appear at the commit with their folders and nothing else remains") {
    const Results results;
    {
        FileSet files;
        results.add_to(files);
        CHECK(file_content(results.folder / "model.json") == "before");
        CHECK_FALSE(fs::exists(results.folder / "model.hpp"));
        CHECK_FALSE(fs::exists(results.folder / "new"));
        files.commit();
        CHECK(results.state() == after);
    }
    CHECK(results.state() == after);
}

TEST_CASE("a set without commit changes nothing") {
    const Results results;
    {
        FileSet files;
        results.add_to(files);
        files.remove(results.folder / "model.json");
    }
    CHECK(results.state() == before);
}

TEST_CASE("a set writes into a folder that exists and creates the folders that are missing in it") {
    const Results results;
    fs::create_directories(results.folder / "new");
    FileSet files;
    results.add_to(files);
    files.commit();
    CHECK(results.state() == after);
}

TEST_CASE("a set keeps the last content of a target that is added twice") {
    const Results results;
    FileSet files;
    files.add(results.folder / "model.json", "first");
    files.add(results.folder / "./model.json", "second");
    files.commit();
    CHECK(results.state() == State{{"model.json", "second"}});
}

TEST_CASE("a set removes earlier results with its commit") {
    const Results results;
    FileSet files;
    files.add(results.folder / "model.hpp", "header");
    files.remove(results.folder / "model.json");
    files.remove(results.folder / "never.json");
    CHECK(results.state().contains("model.json"));
    files.commit();
    CHECK(results.state() == State{{"model.hpp", "header"}});
}

TEST_CASE("a set changes nothing if its last file or folder cannot be renamed") {
    const bool folder = GENERATE(false, true);
    const Results results;
    State expected = before;
    {
        FileSet files;
        results.add_to(files);
        files.add(results.folder / "last", "last");
        const fs::path taken = results.folder / (folder ? "new" : "last");
        fs::create_directory(taken);
        std::ofstream(taken / "of another program") << "kept";
        expected = {{"model.json", "before"},
                    {folder ? "new" : "last", "folder"},
                    {folder ? "new/of another program" : "last/of another program", "kept"}};
        CHECK_THROWS_AS(files.commit(), InputError);
    }
    CHECK(results.state() == expected);
}

TEST_CASE("a set changes nothing if the disk is full in the middle of its last file") {
    const Results results;
    const int status = status_of_child([&] {
        const rlimit limit{100'000, 100'000};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        const fs::path last = results.folder / "new/last.csv";
        try {
            FileSet files;
            results.add_to(files);
            files.add(last) << std::string(200'000, 'x');
            files.commit();
        } catch (const InputError& error) {
            return error.what() == last.string() + ": cannot write: File too large" ? 0 : 1;
        }
        return 2;
    });
    CHECK(WEXITSTATUS(status) == 0);
    CHECK(results.state() == before);
}

TEST_CASE("a set changes nothing if a pipe among its targets is closed") {
    std::array<int, 2> ends{};
    REQUIRE(::pipe(ends.data()) == 0);
    ::close(ends[0]);
    const auto previous = std::signal(SIGPIPE, SIG_IGN);
    const Results results;
    {
        FileSet files;
        files.add("/dev/fd/" + std::to_string(ends[1]), "figures");
        results.add_to(files);
        CHECK_THROWS_AS(files.commit(), InputError);
    }
    std::signal(SIGPIPE, previous);
    ::close(ends[1]);
    CHECK(results.state() == before);
}

TEST_CASE("a set writes a pipe after its files are complete") {
    std::array<int, 2> ends{};
    REQUIRE(::pipe(ends.data()) == 0);
    const Results results;
    {
        FileSet files;
        files.add("/dev/fd/" + std::to_string(ends[1]), "figures");
        CHECK_THROWS_AS(files.add(results.folder / "missing/x", "y"), InputError);
    }
    ::close(ends[1]);
    char byte = 0;
    CHECK(::read(ends[0], &byte, 1) == 0); // nothing was written
    ::close(ends[0]);
}

TEST_CASE("a set opens named pipes one after the other as a reader does") {
    const TemporaryDirectory directory;
    const fs::path first = directory.path() / "first";
    const fs::path second = directory.path() / "second";
    REQUIRE((::mkfifo(first.c_str(), 0600) == 0 && ::mkfifo(second.c_str(), 0600) == 0));
    const pid_t reader = ::fork();
    REQUIRE(reader >= 0);
    if (reader == 0) {
        ::alarm(5);
        const bool model = file_content(first) == "model";
        ::_exit(model && file_content(second) == "header" ? 0 : 1);
    }
    const int status = status_of_child([&] {
        ::alarm(5); // ends a set that waits for ever
        FileSet files;
        files.add(first, "model");
        files.add(second, "header");
        files.commit();
        return 0;
    });
    CHECK(status == 0);
    int read = 0;
    REQUIRE(::waitpid(reader, &read, 0) == reader);
    CHECK(read == 0);
}

TEST_CASE("a set refuses a folder as a target when it is added") {
    const TemporaryDirectory directory;
    FileSet files;
    CHECK_THROWS_MATCHES(
        files.add(directory.path(), "x"), InputError,
        Catch::Matchers::Message(directory.path().string() + ": cannot write: Is a directory"));
}

TEST_CASE("a set removes files with its commit but no folders") {
    const TemporaryDirectory directory;
    fs::create_directory(directory.path() / "folder");
    FileSet files;
    files.remove(directory.path() / "folder");
    files.commit();
    CHECK(fs::exists(directory.path() / "folder"));
}

TEST_CASE("a set leaves nothing when a signal ends the program before the commit") {
    const int signal_number = GENERATE(SIGINT, SIGTERM, SIGHUP);
    const Results results;
    const int status = status_of_child([&] {
        std::signal(signal_number, SIG_DFL); // Catch2 has its own handler
        FileSet files;
        results.add_to(files);
        std::raise(signal_number);
        return 0;
    });
    CHECK(WIFSIGNALED(status));
    CHECK(results.state() == before);
}

TEST_CASE("a set is complete or absent whenever a signal ends the program") {
    DFDYN_SEEDED_ENGINE(engine);
    using Clock = std::chrono::steady_clock;
    const auto begin = Clock::now();
    const int whole = status_of_child([] { // the duration differs with the disk
        const Results results;
        FileSet files;
        results.add_to(files);
        files.commit();
        return 0;
    });
    REQUIRE(whole == 0);
    const auto duration = std::chrono::duration_cast<std::chrono::microseconds>(Clock::now() - begin);
    std::uniform_int_distribution<int> delay_us(0, static_cast<int>(2 * duration.count()));
    int complete = 0;
    constexpr int trials = 60;
    const auto previous = std::signal(SIGTERM, SIG_DFL); // Catch2 has its own handler, which allocates
    for (int trial = 0; trial < trials; ++trial) {
        const Results results;
        const pid_t child = ::fork();
        REQUIRE(child >= 0);
        if (child == 0) {
            FileSet files;
            results.add_to(files);
            files.commit();
            ::pause();
            ::_exit(0);
        }
        std::this_thread::sleep_for(std::chrono::microseconds(delay_us(engine)));
        ::kill(child, SIGTERM);
        int status = 0;
        REQUIRE(::waitpid(child, &status, 0) == child);
        const State state = results.state();
        complete += state == after ? 1 : 0;
        CHECK((state == before || state == after));
    }
    std::signal(SIGTERM, previous);
    CAPTURE(complete);
    CHECK(complete > 0);      // some signals came after the commit
    CHECK(complete < trials); // some before
}

TEST_CASE("a set may have more files than a process may hold open") {
    const TemporaryDirectory directory;
    const int status = status_of_child([&] {
        const rlimit limit{40, 40};
        ::setrlimit(RLIMIT_NOFILE, &limit);
        FileSet files;
        files.add_folder(directory.path() / "a");
        for (int file = 0; file < 50; ++file) {
            files.add(directory.path() / std::to_string(file), "beside");
            files.add(directory.path() / "a" / std::to_string(file), "inside");
        }
        files.commit();
        return 0;
    });
    CHECK(WEXITSTATUS(status) == 0);
    CHECK(directory.file_count() == 51);
    CHECK(state_of(directory.path() / "a").size() == 50);
}

TEST_CASE("a set names the folder that cannot be created") {
    const TemporaryDirectory directory;
    const fs::path file = directory.write("file", "");
    FileSet files;
    CHECK_THROWS_MATCHES(
        files.add_folder(file / "a"), InputError,
        Catch::Matchers::Message((file / "a").string() + ": cannot make the folder: Not a directory"));
    CHECK_THROWS_AS(files.add_folder(file), InputError);
}

} // namespace file_set_test
