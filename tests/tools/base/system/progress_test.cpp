// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/progress.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <fcntl.h>
#include <string>
#include <thread>
#include <unistd.h>

namespace {

using dfdyn::tools::Progress;

/// A terminal whose screen the test reads.
class PseudoTerminal {
  public:
    PseudoTerminal() : master_(::posix_openpt(O_RDWR | O_NOCTTY)) {
        REQUIRE(master_ >= 0);
        REQUIRE(::grantpt(master_) == 0);
        REQUIRE(::unlockpt(master_) == 0);
        std::array<char, 64> name{};
        REQUIRE(::ptsname_r(master_, name.data(), name.size()) == 0);
        slave_ = ::open(name.data(), O_RDWR | O_NOCTTY);
        REQUIRE(slave_ >= 0);
        REQUIRE(::fcntl(master_, F_SETFL, O_NONBLOCK) == 0);
    }
    ~PseudoTerminal() {
        ::close(slave_);
        ::close(master_);
    }
    PseudoTerminal(const PseudoTerminal&) = delete;
    PseudoTerminal& operator=(const PseudoTerminal&) = delete;

    int descriptor() const { return slave_; }

    std::string written() const {
        std::array<char, 4096> text{};
        const ssize_t count = ::read(master_, text.data(), text.size());
        return {text.data(), count < 0 ? 0 : static_cast<std::size_t>(count)};
    }

  private:
    int master_;
    int slave_ = -1;
};

void wait_one_period() { std::this_thread::sleep_for(std::chrono::milliseconds(110)); }

} // namespace

TEST_CASE("Progress shows one line on a terminal and erases it") {
    const PseudoTerminal terminal;
    {
        Progress progress("train", 400, terminal.descriptor());
        wait_one_period();
        progress.update(100);
        CHECK(terminal.written() == "\r\x1b[Ktrain: [#####...............] 100 of 400 (25 %)");
    }
    CHECK(terminal.written() == "\r\x1b[K");
}

TEST_CASE("Progress without a known end shows the count alone") {
    const PseudoTerminal terminal;
    Progress progress("fit", 0, terminal.descriptor());
    wait_one_period();
    progress.update(7);
    CHECK(terminal.written() == "\r\x1b[Kfit: 7");
}

TEST_CASE("Progress writes nothing for short work and at most once a period") {
    const PseudoTerminal terminal;
    const auto wait_ms = GENERATE(0, 110);
    const auto start = std::chrono::steady_clock::now();
    Progress progress("work", 1000, terminal.descriptor());
    std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
    for (std::size_t done = 1; done <= 1000; ++done) {
        progress.update(done);
    }
    const auto periods = (std::chrono::steady_clock::now() - start) / std::chrono::milliseconds(100);
    const std::string written = terminal.written();
    CAPTURE(wait_ms, written, periods); // one period, unless the machine is very busy
    CHECK(std::count(written.begin(), written.end(), '\r') <= periods);
}

/// A pipe whose end the test reads without waiting.
class LogPipe {
  public:
    LogPipe() { REQUIRE(::pipe2(ends_.data(), O_NONBLOCK) == 0); }
    ~LogPipe() {
        ::close(ends_[0]);
        ::close(ends_[1]);
    }
    LogPipe(const LogPipe&) = delete;
    LogPipe& operator=(const LogPipe&) = delete;

    int descriptor() const { return ends_[1]; }

    std::string written() const {
        std::array<char, 4096> text{};
        const ssize_t count = ::read(ends_[0], text.data(), text.size());
        return {text.data(), count < 0 ? 0 : static_cast<std::size_t>(count)};
    }

  private:
    std::array<int, 2> ends_{};
};

TEST_CASE("Progress of short work is silent in a pipe") {
    const LogPipe pipe;
    {
        Progress progress("train", 400, pipe.descriptor());
        wait_one_period();
        progress.update(100);
    }
    CHECK(pipe.written().empty());
}

TEST_CASE("Progress of long work writes plain lines into a pipe with one a period over all objects") {
    const LogPipe pipe;
    constexpr std::chrono::milliseconds plain{250};
    for (const char* const label : {"first", "second"}) {
        Progress progress(label, 400, pipe.descriptor(), plain);
        progress.update(1);
        std::this_thread::sleep_for(plain + std::chrono::milliseconds(10));
        progress.update(100);
        progress.update(200);
        CHECK(pipe.written() == std::string(label) + ": 100 of 400 (25 %)\n");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(110)); // longer than the period of a terminal
    Progress progress("third", 400, pipe.descriptor(), std::chrono::seconds(60));
    progress.update(1);
    CHECK(pipe.written().empty());
}

TEST_CASE("an activity shows its elapsed seconds") {
    const PseudoTerminal terminal;
    {
        const dfdyn::tools::Activity activity("solving", terminal.descriptor());
        std::this_thread::sleep_for(std::chrono::milliseconds(400));
        CHECK(terminal.written().starts_with("\r\x1b[Ksolving: 0 s"));
    }
    CHECK(terminal.written().ends_with("\r\x1b[K"));
    const LogPipe pipe;
    {
        const dfdyn::tools::Activity activity("solving", pipe.descriptor(), std::chrono::milliseconds(150));
        std::this_thread::sleep_for(std::chrono::milliseconds(600));
    }
    const std::string lines = pipe.written();
    CHECK(lines.starts_with("solving: 0 s\n"));
    CHECK(std::ranges::count(lines, '\n') <= 4);
}

TEST_CASE("Progress shows fractions as tenths") {
    const PseudoTerminal terminal;
    Progress progress("units", 360, terminal.descriptor());
    wait_one_period();
    progress.update_part(37.44);
    CHECK(terminal.written().ends_with("units: [##..................] 37.4 of 360 (10 %)"));
}
