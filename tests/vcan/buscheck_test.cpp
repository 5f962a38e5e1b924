// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tests/vcan/peer.hpp"

#include <csignal>

using Catch::Matchers::Contains;
using dfdyn::tests::Background;
using dfdyn::tests::IcubLog;
using dfdyn::tests::run;

TEST_CASE("buscheck on a live bus reports senders and missing senders", "[virtual_time]") {
    const IcubLog log(75, 50); // 1.5 s
    const auto played = log.without(" 3DB#");
    const auto bus = log.directory.write("bus.json", dfdyn::tests::icub_arm_at(50));
    const std::string program = DFDYN_PROGRAM;
    const Background check(program + " buscheck --can vcan0 --duration 60 --bus " + bus.string());
    run(program + " play --log " + played.string() + " --can vcan0");
    check.signal(SIGINT); // waiting frames are read before it ends
    const std::string report = check.output(20);
    CAPTURE(report);
    CHECK_THAT(report, Contains("silent_source: 0x3DB (sensor) is never sent"));
    for (const char* const id : {"0x111", "0x121", "0x3DA"}) {
        CHECK_THAT(report, !Contains(std::string("silent_source: ") + id));
        CHECK_THAT(report, !Contains(std::string("rejected_frames: ") + id));
    }
    CHECK_THAT(report, Contains("bus: error-active;"));
    CHECK_THAT(report, Contains("frames were sent by programs of this computer"));
}

TEST_CASE("buscheck reports an interface that goes down and returns", "[virtual_time]") {
    const dfdyn::tests::TemporaryDirectory directory;
    const auto bus = directory.write("bus.json", dfdyn::tests::icub_arm_at(50));
    run("ip link add dev vcan4 type vcan && ip link set vcan4 up");
    std::string report;
    {
        const Background check(std::string(DFDYN_PROGRAM) + " buscheck --can vcan4 --duration 60 --bus " +
                               bus.string());
        run("ip link set vcan4 down && sleep 0.2 && ip link set vcan4 up && sleep 0.2");
        run("cansend vcan4 111#0000000000000000 && sleep 0.2"); // proves that the interface was opened again
        check.signal(SIGINT);
        report = check.output(20);
    }
    run("ip link del vcan4");
    CAPTURE(report);
    CHECK_THAT(report, Contains("interface_down: the interface went down"));
    CHECK_THAT(report, Contains("1 times down"));
    CHECK_THAT(report, !Contains("silent_bus"));
}
