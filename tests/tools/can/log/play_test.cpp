// SPDX-License-Identifier: Apache-2.0
#include "tools/can/log/play.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/base/text/error.hpp"

using dfdyn::tools::InputError;
using dfdyn::tools::Lateness;
using dfdyn::tools::play;
using dfdyn::tools::PlayOptions;
using dfdyn::tools::PlayTimes;

TEST_CASE("intervals between due times are those of the log or scaled by the rate") {
    PlayTimes times(5'000, 1.0);
    CHECK(times.due_ns(1'700'000'000'000'000'000) == 5'000);
    CHECK(times.due_ns(1'700'000'000'000'000'000) == 5'000);
    CHECK(times.due_ns(1'700'000'000'000'000'700) == 5'700);
    PlayTimes fast(5'000, 10.0);
    CHECK(fast.due_ns(1'000) == 5'000);
    CHECK(fast.due_ns(3'000) == 5'200);
    CHECK(fast.backward_stamps() == 0);
}

TEST_CASE(
    "a frame whose time stamp runs backward is due with its predecessor and the log continues from there") {
    PlayTimes times(0, 1.0);
    CHECK(times.due_ns(9'000) == 0);
    CHECK(times.due_ns(9'500) == 500);
    CHECK(times.due_ns(2'000) == 500);
    CHECK(times.due_ns(2'300) == 800);
    CHECK(times.backward_stamps() == 1);
}

TEST_CASE("a frame of the year 2262 is due in the far future and not in the past") {
    PlayTimes times(1'000'000'000'000'000, 0.001);
    times.due_ns(0);
    CHECK(times.due_ns(9'223'372'035'000'000'000) > 9'000'000'000'000'000'000);
}

TEST_CASE("lateness has a median and a maximum") {
    Lateness none;
    CHECK(none.median_us() == 0);
    Lateness lateness;
    for (const std::int64_t value_us : {70, 10, 20, 30, 50'000}) {
        lateness.add(value_us);
    }
    CHECK(lateness.median_us() == 30);
    CHECK(lateness.worst_us() == 50'000);
    Lateness hopeless;
    hopeless.add(50'000);
    CHECK(hopeless.median_us() == 10'000);
}

TEST_CASE("a log that has an error anywhere or no frames or does not exist is not played") {
    const dfdyn::tests::TemporaryDirectory directory;
    const std::atomic<bool> stop = false;
    const auto options = [&](const std::string& text) {
        PlayOptions out;
        out.log = directory.write("run.log", text);
        out.interface = "no_such_can";
        return out;
    };
    const auto message = [&](const std::string& text) {
        return Catch::Matchers::Message((directory.path() / "run.log").string() + text);
    };
    CHECK_THROWS_MATCHES(
        play(options("(1.000000) can0 001#\n(1.000000) can0 1#\n"), stop), InputError,
        message(":2:17: expected an identifier of 3 or 8 hexadecimal digits and #, found \"1#\""));
    CHECK_THROWS_MATCHES(play(options("# nothing\n"), stop), InputError,
                         message(": expected frames, found none"));
    PlayOptions chosen = options("(1.000000) can0 001#\n");
    chosen.log_interface = "can1";
    CHECK_THROWS_MATCHES(play(chosen, stop), InputError,
                         message(": expected frames of \"can1\", found none"));
    chosen.log = "none.log";
    CHECK_THROWS_AS(play(chosen, stop), InputError);
    CHECK_THROWS_MATCHES(play(options("(1.000000) can0 001#\n"), stop), InputError,
                         Catch::Matchers::Predicate<InputError>([](const InputError& error) {
                             return std::string(error.what()).starts_with("no_such_can: expected ");
                         }));
}
