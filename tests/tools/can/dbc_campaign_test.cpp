// SPDX-License-Identifier: Apache-2.0
// The random campaign for devices that a DBC file describes.
#include "tests/hal/campaign/campaign_table.hpp"
#include "tools/can/description/dbc_device.hpp"

namespace dbc_campaign_test {

using namespace dfdyn::tests;
using dfdyn::tools::DbcField;
using dfdyn::tools::DbcJoint;
using dfdyn::tools::DbcSensor;
namespace hal = dfdyn::hal;

DbcField field(std::uint32_t id, int start_bit, int bits, hal::ByteOrder order, double factor) {
    DbcField result;
    result.id = id;
    result.length = 6;
    result.signal = {.start_bit = start_bit,
                     .length = bits,
                     .byte_order = order,
                     .encoding = hal::Encoding::signed_integer,
                     .factor = factor};
    return result;
}

/// A message per joint, most significant byte first: position in µrad and effort in thousandths.
struct DbcArm {
    static constexpr const char* name = "dbc, efforts";
    static constexpr bool efforts = true;
    static constexpr bool synchronous = false;
    static constexpr double step = 1e-6;
    static constexpr double output_range = 0;
    using Board = DbcJoint;
    using Assembly = hal::SampleAssembly<double, 2, Board, 2, hal::EffortOutput<2, 16>>;

    static Board board(std::uint32_t id, int joint) {
        constexpr auto order = hal::ByteOrder::motorola;
        return Board({.joint = joint,
                      .position = field(id, 7, 32, order, 1e-6),
                      .effort = field(id, 39, 16, order, 1e-3)});
    }
    static Assembly make(const hal::MotionLimits& limits) {
        return {campaign_config<Assembly>({board(0x120, 0), board(0x121, 1)}, limits), campaign_efforts()};
    }
    static void start(const Scene& /*scene*/, Traffic& /*traffic*/) {}
    static void cycle(const Scene& scene, int k, Traffic& traffic) {
        for (unsigned i = 0; i < 2; ++i) {
            const std::int64_t measured = scene.cycle_ns(k) + joint_phase(static_cast<int>(i));
            const double t = dfdyn::tests::seconds_of(measured);
            const long long q = std::llround(1e6 * scene.truth.position(i, t));
            const long long e = std::llround(1e3 * scene.truth.effort(i, t) + scene.noise(2));
            send(traffic,
                 wire::frame(0x120 + i, {wire::byte_of(q, 3), wire::byte_of(q, 2), wire::byte_of(q, 1),
                                         wire::byte_of(q, 0), wire::byte_of(e, 1), wire::byte_of(e, 0)}),
                 measured + scene.jitter(), Sent::Role::joints, static_cast<int>(i), k);
        }
    }
};

/// The same joints with a sensor of two messages, least significant byte first.
struct DbcWrenchArm : DbcArm {
    static constexpr const char* name = "dbc, dbc sensor";
    static constexpr bool efforts = false;
    static constexpr double output_range = 32768.0 / 50;
    using Assembly = hal::SampleAssembly<double, 2, Board, 2, hal::WrenchOutput<DbcSensor, 16>>;

    static Assembly make(const hal::MotionLimits& limits) {
        std::array<DbcField, 6> fields;
        for (int i = 0; i < 6; ++i) {
            fields[static_cast<std::size_t>(i)] =
                field(i < 3 ? 0x160 : 0x161, 16 * (i % 3), 16, hal::ByteOrder::intel, 0.02);
        }
        return {campaign_config<Assembly>({board(0x120, 0), board(0x121, 1)}, limits),
                campaign_wrench(DbcSensor(fields), 655)};
    }
    static void cycle(const Scene& scene, int k, Traffic& traffic) {
        DbcArm::cycle(scene, k, traffic);
        const std::int64_t measured = scene.cycle_ns(k) + wrench_phase;
        const wire::SixWords raw = load_counts(scene, measured, 0x8000);
        const auto half = [&](std::uint32_t id, std::size_t from) {
            return wire::frame(id, {wire::byte_of(raw[from], 0), wire::byte_of(raw[from], 1),
                                    wire::byte_of(raw[from + 1], 0), wire::byte_of(raw[from + 1], 1),
                                    wire::byte_of(raw[from + 2], 0), wire::byte_of(raw[from + 2], 1)});
        };
        send_wrench(scene, k, {half(0x160, 0), half(0x161, 3)}, measured, traffic);
    }
};

void fight_all(std::uint64_t frames) {
    DFDYN_SEEDED_ENGINE(engine);
    print_header();
    CampaignRow sum;
    for (const Trigger trigger : {Trigger::timer, Trigger::set}) {
        fight<DbcArm>(trigger, frames / 4, engine, sum);
        fight<DbcWrenchArm>(trigger, frames / 4, engine, sum);
    }
    CHECK(share(sum.refused_good, sum.good) < 0.03);
}

TEST_CASE("no mixture of faults makes a wrong value of a DBC file valid") { fight_all(60'000); }

TEST_CASE("no mixture of faults in a million frames makes a wrong value of a DBC file valid", "[.long]") {
    fight_all(1'000'000);
}

} // namespace dbc_campaign_test
