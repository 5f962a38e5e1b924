// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/cia402.hpp"
#include "tests/hal/support/wire.hpp"

namespace dfdyn::tests::families {

struct cia402 {
    static constexpr const char* dbc = "cia402.dbc";

    static auto boards() noexcept {
        return std::array{hal::Cia402Drive({.node = 1, .joint = 0, .effort_pdo = 0x380}),
                          hal::Cia402Drive({.node = 2, .joint = 1, .effort_pdo = 0x380})};
    }
    static auto other_frames() noexcept {
        const auto drives = boards();
        return std::array{hal::Cia402Drive::encode_sync(),
                          drives[0].encode_heartbeat(hal::Cia402Drive::State::operational),
                          drives[1].encode_emcy(0)};
    }

    /// SYNC 0x080; TPDO 0x280 + N: 0x6064 int32 and 0x6077 int16 (thousandths), least significant byte first,
    /// measured at the SYNC.
    struct on_wire {
        static constexpr double step_rad = wire::turn / 1048576;
        static constexpr bool synchronous = true;

        static hal::Cia402Drive drive(int node, bool at_sync, int bits, double zero_rad) noexcept {
            const int length = bits / 8 + 2;
            return hal::Cia402Drive({.node = node,
                                     .joint = node - 1,
                                     .position_pdo = 0x280,
                                     .position_length = length,
                                     .position = {.start_bit = 0,
                                                  .length = bits,
                                                  .encoding = hal::Encoding::signed_integer,
                                                  .factor = wire::turn / (bits == 16 ? 65536 : 1048576),
                                                  .offset = zero_rad},
                                     .effort_pdo = 0x280,
                                     .effort_length = length,
                                     .effort = {.start_bit = bits,
                                                .length = 16,
                                                .encoding = hal::Encoding::signed_integer,
                                                .factor = 1e-3},
                                     .synchronous = at_sync});
        }
        static auto boards() noexcept { return std::array{drive(1, true, 32, 0), drive(2, true, 32, 0)}; }
        static wire::Frames frames(std::size_t board, const wire::Joints& joints) {
            const long long q = wire::int32(joints[board].position_rad / step_rad);
            const long long t = wire::int16(1000 * joints[board].effort);
            using wire::byte_of;
            return wire::one(
                wire::frame(board == 0 ? 0x281 : 0x282, {byte_of(q, 0), byte_of(q, 1), byte_of(q, 2),
                                                         byte_of(q, 3), byte_of(t, 0), byte_of(t, 1)}));
        }
        static auto status() { return std::array<hal::Frame, 0>{}; }
    };
};

} // namespace dfdyn::tests::families
