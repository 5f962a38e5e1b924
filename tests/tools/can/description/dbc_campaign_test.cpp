// SPDX-License-Identifier: Apache-2.0
// The random campaign for devices that a DBC file describes.
#include "tests/hal/campaign/arm_of_family.hpp"
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
struct DbcJoints {
    struct on_wire {
        static constexpr double step_rad = 1e-6;

        static DbcJoint board(std::uint32_t id, int joint) {
            constexpr auto order = hal::ByteOrder::motorola;
            return DbcJoint({.joint = joint,
                             .position = field(id, 7, 32, order, 1e-6),
                             .effort = field(id, 39, 16, order, 1e-3)});
        }
        static auto boards() { return std::array{board(0x120, 0), board(0x121, 1)}; }
        static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
            const long long q = wire::int32(1e6 * joints[board].position_rad);
            const long long e = wire::int16(1e3 * joints[board].effort);
            using wire::byte_of;
            return wire::one(
                wire::frame(board == 0 ? 0x120 : 0x121, {byte_of(q, 3), byte_of(q, 2), byte_of(q, 1),
                                                         byte_of(q, 0), byte_of(e, 1), byte_of(e, 0)}));
        }
        static auto status() { return std::array<hal::Frame, 0>{}; }
    };
};

/// A sensor of two messages, least significant byte first.
struct DbcWrench {
    struct on_wire {
        static constexpr double range = 32768.0 / 50;

        static auto sensor() {
            std::array<DbcField, 6> fields;
            for (int i = 0; i < 6; ++i) {
                fields[static_cast<std::size_t>(i)] =
                    field(i < 3 ? 0x160 : 0x161, 16 * (i % 3), 16, hal::ByteOrder::intel, 0.02);
            }
            return DbcSensor(fields);
        }
        static wire::Frames frames(const wire::SixWords& raw) {
            const auto half = [&](std::uint32_t id, std::size_t from) {
                using wire::byte_of;
                return wire::frame(id, {byte_of(raw[from], 0), byte_of(raw[from], 1),
                                        byte_of(raw[from + 1], 0), byte_of(raw[from + 1], 1),
                                        byte_of(raw[from + 2], 0), byte_of(raw[from + 2], 1)});
            };
            return {{half(0x160, 0), half(0x161, 3)}, 2};
        }
        static void saturate(hal::Frame& frame, std::size_t /*half*/) {
            frame.data[0] = 0xFF;
            frame.data[1] = 0x7F;
        }
        static auto status() { return std::array<hal::Frame, 0>{}; }
    };
};

void fight_all(std::uint64_t frames) {
    DFDYN_SEEDED_ENGINE(engine);
    print_header();
    CampaignRow sum;
    for (const CampaignArm& arm : {arm_with_efforts<DbcJoints>("dbc, efforts"),
                                   arm_with_sensor<DbcJoints, DbcWrench>("dbc, dbc sensor")}) {
        for (const Trigger trigger : {Trigger::timer, Trigger::set}) {
            fight(arm, trigger, {}, frames / 4, engine, sum);
        }
    }
    check_sum(sum, 0, 0.05);
}

TEST_CASE("no mixture of faults makes a wrong value of a DBC file valid") { fight_all(240'000); }

TEST_CASE("no mixture of faults in a million frames makes a wrong value of a DBC file valid", "[.long]") {
    fight_all(1'000'000);
}

} // namespace dbc_campaign_test
