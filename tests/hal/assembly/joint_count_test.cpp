// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/device/cia402.hpp"
#include "tests/hal/support/arm_on_bus.hpp"
#include "tests/support/seed.hpp"

#include <random>

namespace joint_count_test {

using namespace dfdyn::hal;
using namespace dfdyn::tests;

template <int n>
using Efforts = EffortOutput<n, 8>;
template <int n>
using Arm = SampleAssembly<double, n, Cia402Drive, 3, Efforts<n>, 8>;

std::array<Cia402Drive, 3> three_drives() {
    const auto drive = [](int joint) {
        return Cia402Drive({.node = joint + 1, .joint = joint, .effort_pdo = 0x380, .effort_length = 2});
    };
    return {drive(0), drive(1), drive(2)};
}

template <int n>
Arm<n> make_arm(dfdyn::Extent<n> joints) {
    const TrackConfig track{.max_age_ns = 15 * ms,
                            .latency_ns = 0,
                            .qualification = {.readings = 3, .zero_readings = 100},
                            .period_ns = 10 * ms};
    typename Arm<n>::Config config{.board = three_drives(),
                                   .position = track,
                                   .position_range = {},
                                   .clock = {},
                                   .limits = {},
                                   .joints = joints};
    config.position_range.fill({-10, 10});
    config.limits.fill({30, 1000});
    typename Efforts<n>::Config efforts{.track = track, .range = {}, .joints = joints};
    efforts.range.fill({-30, 30});
    return {config, Efforts<n>(efforts)};
}

TEST_CASE("a run-time number of joints gives the same samples as a fixed number") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_real_distribution<double> chance(0, 1);
    Arm<3> fixed = make_arm<3>({});
    Arm<dfdyn::dynamic> sized = make_arm<dfdyn::dynamic>({3});
    const std::array<Cia402Drive, 3> drives = three_drives();
    int samples = 0;
    int outputs = 0;
    for (int cycle = 0; cycle < 2000; ++cycle) {
        const std::int64_t sync_ns = cycle * 10 * ms;
        const auto take = [&](const Frame& frame, std::int64_t stamp_ns) {
            const auto moment = fixed.take(at_time(frame, stamp_ns), stamp_ns);
            const auto other = sized.take(at_time(frame, stamp_ns), stamp_ns);
            REQUIRE(moment.kind == other.kind);
            REQUIRE(moment.instant_ns == other.instant_ns);
        };
        take(Cia402Drive::encode_sync(), sync_ns);
        for (int joint = 0; joint < 3; ++joint) {
            std::array<JointValue, 1> value{};
            value[0].position_rad = 0.5 * std::sin(0.01 * cycle + joint);
            value[0].effort = 5 * std::sin(0.3 * cycle + joint);
            const FrameList answer = drives[static_cast<std::size_t>(joint)].encode(value);
            for (int f = 0; f < answer.count; ++f) {
                if (chance(engine) < 0.99) { // loss of 1 %
                    take(answer.frame[static_cast<std::size_t>(f)], sync_ns + (joint + 1) * ms);
                }
            }
        }
        const std::int64_t instant_ns = sync_ns + 2 * ms;
        const std::int64_t now_ns = sync_ns + 5 * ms;
        REQUIRE(fixed.pending(instant_ns, now_ns) == sized.pending(instant_ns, now_ns));
        const auto one = fixed.assemble(instant_ns, now_ns);
        const auto other = sized.assemble(instant_ns, now_ns);
        REQUIRE(one.report.position == other.report.position);
        REQUIRE(one.report.output == other.report.output);
        REQUIRE(std::ranges::equal(one.positions(), other.positions()));
        REQUIRE(std::ranges::equal(one.joint_reasons(), other.joint_reasons()));
        REQUIRE(std::ranges::equal(one.valid_outputs(), other.valid_outputs()));
        samples += other.valid() ? 1 : 0;
        outputs += static_cast<int>(other.valid_outputs().size());
    }
    CHECK(samples > 100); // both variants were compared
    CHECK(samples < 1900);
    CHECK(outputs > 300);
    CHECK(sized.counters().positions_refused == fixed.counters().positions_refused);
}

} // namespace joint_count_test
