// SPDX-License-Identifier: Apache-2.0
// A position that a DBC file describes with a finer resolution than its encoder has.
#include "dfdyn/hal/motion/motion.hpp"
#include "tests/support/catch.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tools/base/text/error.hpp"
#include "tools/can/arm/device_frames.hpp"

#include <cmath>
#include <numbers>

namespace dbc_count_test {

using namespace dfdyn::tools;
namespace hal = dfdyn::hal;

constexpr double count_rad = 2 * std::numbers::pi / 4096; ///< 12 bits

/// An arm with a joint whose position is a float. `count`: text of the field `count_rad`, or nothing.
BusDescription arm_with(const std::string& count) {
    const dfdyn::tests::TemporaryDirectory directory;
    directory.write("arm.dbc", "BO_ 288 Drive: 6 A\n"
                               " SG_ Q : 0|32@1- (1,0) [0|0] \"rad\" B\n"
                               " SG_ I : 32|16@1- (0.001,0) [0|0] \"A\" B\n"
                               "SIG_VALTYPE_ 288 Q : 1;\n");
    return read_bus_description(
        directory.write("bus.json", R"({"schema": "dfdyn.bus/1", "bit_rate": 1000000, "sample_rate_hz": 500,
            "trigger": {"on": "timer"}, "joints": {"family": "dbc", "file": "arm.dbc", "boards": [
                {"joint": 1, "position": {"message": "Drive", "signal": "Q")" +
                                        count + R"(}, "effort": {"message": "Drive", "signal": "I"}}]},
            "output": {"family": "efforts", "quantity": "i"}})"));
}

/// Number of trusted readings among 1000 of a motion at 0.19 rad/s.
int trusted(const BusDescription& arm) {
    constexpr std::int64_t period_ns = 2'000'000;
    const DeviceFrames device(arm);
    AnyBoard board = arm.boards.front().board;
    hal::MotionGate gate({.limits = {},
                          .range = {-3, 3},
                          .max_age_ns = 3 * period_ns,
                          .period_ns = period_ns,
                          .jitter_ns = period_ns / 10,
                          .qualification = {.readings = 10, .zero_readings = 1000}});
    int count = 0;
    for (int tick = 0; tick < 1000; ++tick) {
        const double position_rad = count_rad * std::round((0.4 + 0.19 * 2e-3 * tick) / count_rad);
        const auto frames = device.joints(std::vector<double>{position_rad}, std::vector<double>{0});
        const hal::JointValue value = board.decode(frames.front()).joint[0];
        count += gate.take({.stamp_ns = tick * period_ns,
                            .position_rad = value.position_rad,
                            .step_rad = value.step_rad,
                            .from_zero_rad = value.from_zero_rad})
                             .reason == hal::Reason::ok
                     ? 1
                     : 0;
    }
    return count;
}

TEST_CASE("a slow joint with a float position is trusted if the description has its encoder's count") {
    CHECK(trusted(arm_with(R"(, "count_rad": 0.00153398)")) == 991);
    CHECK(trusted(arm_with("")) == 0);
    CHECK_THROWS_WITH(arm_with(R"(, "count_rad": 0)"), Catch::Matchers::Contains("position.count_rad: "));
    CHECK_THROWS_WITH(arm_with(R"(, "count_rad": 1)"), Catch::Matchers::Contains("position.count_rad: "));
}

} // namespace dbc_count_test
