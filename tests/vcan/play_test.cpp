// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/candump.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_frame.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/vcan/peer.hpp"

#include <cmath>
#include <cstdlib>
#include <sstream>
#include <string>
#include <sys/wait.h>
#include <vector>

namespace {

using dfdyn::hal::CandumpLine;
using dfdyn::hal::CandumpText;
using dfdyn::hal::Frame;
using dfdyn::tests::Background;
using dfdyn::tests::content;
using dfdyn::tests::run;
using dfdyn::tests::TemporaryDirectory;

constexpr std::int64_t period_ns = 5'000'000;
constexpr std::int64_t first_stamp_ns = 1'700'000'000'000'000'000;

std::string log_text(const std::vector<Frame>& frames) {
    std::string log = "# every kind of frame\n";
    for (std::size_t index = 0; index < frames.size(); ++index) {
        CandumpText text{};
        log.append(write_candump_line(frames[index], "can7", dfdyn::hal::StampDecimals::nanoseconds, text))
            .append("\n");
        if (index == 10) {
            log += "DROPCOUNT: dropped 1 CAN frame on 'can7' socket (total drops 1)\n";
        }
    }
    return log;
}

std::vector<Frame> frames_of(const std::string& log) {
    std::istringstream lines(log);
    std::vector<Frame> frames;
    for (std::string text; std::getline(lines, text);) {
        const CandumpLine line = dfdyn::hal::parse_candump_line(text);
        REQUIRE(line.kind == CandumpLine::Kind::frame);
        frames.push_back(line.frame);
    }
    return frames;
}

} // namespace

TEST_CASE("candump receives the frames of dfdyn play in order, at the log's rate or a multiple of it") {
    DFDYN_SEEDED_ENGINE(engine);
    std::vector<Frame> played;
    std::vector<Frame> on_the_wire;
    for (int count = 0; count < 60; ++count) {
        played.push_back(dfdyn::tests::random_frame(engine));
        played.back().stamp_ns = first_stamp_ns + count * period_ns;
        if (!played.back().error) {
            on_the_wire.push_back(played.back());
        }
    }
    const double rate = GENERATE(1.0, 4.0);
    CAPTURE(rate);
    const TemporaryDirectory directory;
    const std::string log = directory.write("run.log", log_text(played)).string();
    const Background candump("candump -L vcan0");
    const std::string report = run(std::string(DFDYN_PROGRAM) + " play --log " + log +
                                   " --can vcan0 --rate " + std::to_string(rate));
    CHECK_THAT(report, Catch::Matchers::ContainsSubstring(std::to_string(on_the_wire.size()) +
                                                          " frames sent, 0 refused; lateness median "));
    CHECK_THAT(report, Catch::Matchers::ContainsSubstring(" error frames left out"));
    const std::vector<Frame> seen = frames_of(candump.output(on_the_wire.size()));
    REQUIRE(seen.size() == on_the_wire.size());
    for (std::size_t index = 0; index < seen.size(); ++index) {
        CHECK(content(seen[index]) == content(on_the_wire[index]));
    }
    // The run takes as long as the log divided by the rate, plus the delays of the machine.
    const double late_s = 1e-6 * dfdyn::tests::number_after(report, "us, worst ");
    const double log_s =
        1e-9 * static_cast<double>(on_the_wire.back().stamp_ns - on_the_wire.front().stamp_ns);
    const double seen_s = 1e-9 * static_cast<double>(seen.back().stamp_ns - seen.front().stamp_ns);
    CHECK(std::abs(seen_s - log_s / rate) < late_s + 0.02);
}

TEST_CASE("Ctrl-C ends dfdyn play before the end of the log, with a report") {
    const TemporaryDirectory directory;
    const std::string log =
        directory.write("run.log", "(1.000000) can0 123#\n(9999.000000) can0 456#\n").string();
    const std::string output = directory.path() / "output";
    const std::string command = "timeout --preserve-status --signal=INT 3 " + std::string(DFDYN_PROGRAM) +
                                " play --log " + log + " --can vcan0 >" + output;
    const int status = std::system(command.c_str());
    REQUIRE(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 1);
    CHECK_THAT(dfdyn::tests::file_content(output),
               Catch::Matchers::StartsWith("1 frames sent, 0 refused; ") &&
                   Catch::Matchers::EndsWith("stopped before the end of the log\n"));
}
