// SPDX-License-Identifier: Apache-2.0
// The loop and the arm as two programs with a bus between them. Nothing here depends on how fast they run.
#include "tests/support/catch.hpp"
#include "tests/vcan/peer.hpp"

#include <chrono>
#include <csignal>
#include <string>
#include <thread>

namespace {

using Catch::Matchers::ContainsSubstring;
using dfdyn::tests::Background;
using dfdyn::tests::run;

std::string program(const std::string& subcommand, const std::string& interface) {
    const std::string data = DFDYN_TEST_DATA_DIR;
    return std::string(DFDYN_PROGRAM) + " " + subcommand + " --robot " + data +
           "/robots/small_arm/small_arm.urdf --scenario " + data + "/scenarios/small_arm_loop.json --bus " +
           data + "/can/small_arm_loop.json --can " + interface;
}

/// Lines of what a loop prints: a note where it is no real-time program, the loop, the pace.
std::string last_words(const Background& loop) { return loop.output(2); }

} // namespace

TEST_CASE("a loop moves the arm of another program, and both end when they are asked to") {
    const Background plant(program("plant", "vcan0"));
    const std::string said = run(program("loop", "vcan0") + " --duration 2");
    CHECK_THAT(said, ContainsSubstring("stopped (requested)"));
    CHECK_THAT(said, ContainsSubstring("followed the reference"));
    CHECK_THAT(said, ContainsSubstring("; 0 command frames refused"));
    plant.signal(SIGINT);
    const std::string plant_said = plant.output(1);
    CHECK_THAT(plant_said, ContainsSubstring("command frames"));
    CHECK_THAT(plant_said, !ContainsSubstring(" 0 command frames"));
}

TEST_CASE("a loop whose arm falls silent stops by itself, and says why") {
    const Background loop(program("loop", "vcan0"));
    {
        const Background plant(program("plant", "vcan0"));
        std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    }
    CHECK_THAT(last_words(loop), ContainsSubstring("stopped (no_position)"));
}

TEST_CASE("a loop whose interface goes down stops by itself, and says why") {
    run("ip link add dev vcan4 type vcan && ip link set vcan4 up");
    {
        const Background plant(program("plant", "vcan4"));
        const Background loop(program("loop", "vcan4"));
        std::this_thread::sleep_for(std::chrono::milliseconds(1500));
        run("ip link set vcan4 down");
        CHECK_THAT(last_words(loop), ContainsSubstring("stopped (bus_lost)"));
    }
    run("ip link del vcan4");
}

TEST_CASE("a check of a bus finds the arm in order, and finds it missing") {
    const std::string check = std::string(DFDYN_PROGRAM) + " buscheck --bus " + DFDYN_TEST_DATA_DIR +
                              "/can/small_arm_loop.json --can vcan0 --duration 1";
    CHECK_THAT(run(check + " || true"), ContainsSubstring("finding silent_source"));
    const Background plant(program("plant", "vcan0"));
    CHECK_THAT(run(check + " || true"), !ContainsSubstring("finding silent_source"));
}
