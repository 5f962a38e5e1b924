// SPDX-License-Identifier: Apache-2.0
// A live replay that runs unattended for a long time, or is killed.
#include "tests/support/catch.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tests/vcan/peer.hpp"
#include "tools/base/text/error.hpp"
#include "tools/replay/replay_csv.hpp"
#include "tools/replay/replay_interface.hpp"

#include <algorithm>
#include <csignal>

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::file_content;
using dfdyn::tests::IcubLog;

/// Replays the frames on vcan0 until it is killed.
[[noreturn]] void replay_for_ever(const IcubLog& log, const std::filesystem::path& csv,
                                  const std::filesystem::path& record) {
    const std::atomic<bool> stop = false;
    const auto estimator = make_estimator(log.model, true);
    ReplayCsvFile sink(csv, log.model);
    replay_interface(*estimator, {&log.model, 1}, log.bus, {"vcan0", 0, record, {1000, &sink}}, 0, stop);
    ::_exit(1);
}

/// Number of complete lines of a file, which need not exist.
long lines(const std::filesystem::path& path) {
    return std::filesystem::exists(path) ? std::ranges::count(file_content(path), '\n') : 0;
}

} // namespace

TEST_CASE("the output of a killed live replay is complete except for its last line") {
    // 0.6 s, which fit into a socket's buffer: a machine that stalls loses no frame
    const IcubLog log(60, 100);
    const auto csv = log.directory.path() / "out.csv";
    const auto record = log.directory.path() / "recorded.log";
    const long receivers = dfdyn::tests::receivers();
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        replay_for_ever(log, csv, record);
    }
    CHECK(dfdyn::tests::wait_for_receivers(receivers));
    dfdyn::tests::run(std::string(DFDYN_PROGRAM) + " play --log " + log.path.string() + " --can vcan0");
    // It flushes both files four times a second.
    constexpr long frames = 4 * 60 + 6;
    CHECK(dfdyn::tests::wait_for([&] { return lines(csv) > 50 && lines(record) >= frames; }));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);

    CHECK_THAT(file_content(csv), Catch::Matchers::StartsWith("t,fx,fx_pred,fx_std,"));
    const auto estimator = make_estimator(log.model, true);
    const ReplayedBus again = replay_log(*estimator, {&log.model, 1}, log.bus, record, "", 0);
    CHECK(again.bus.frames == frames);
}

TEST_CASE("a live replay on a silent bus sleeps") {
    const IcubLog log(10, 100);
    const auto estimator = make_estimator(log.model, true);
    const std::atomic<bool> stop = false;
    rusage before{};
    ::getrusage(RUSAGE_THREAD, &before);
    CHECK_THROWS_AS(replay_interface(*estimator, {&log.model, 1}, log.bus, {"vcan0", 1.0, {}, {}}, 0, stop),
                    InputError);
    rusage after{};
    ::getrusage(RUSAGE_THREAD, &after);
    CHECK(after.ru_nvcsw - before.ru_nvcsw < 50); // ten wake-ups a second
}
