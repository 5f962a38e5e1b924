// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/cia402.hpp"

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
};

} // namespace dfdyn::tests::families
