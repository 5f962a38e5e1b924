// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/ati_netcan.hpp"

namespace dfdyn::tests::families {

struct ati_netcan {
    static constexpr const char* dbc = "ati_netcan.dbc";

    static auto sensor() noexcept {
        hal::AtiNetcan::Config config;
        for (std::size_t i = 0; i < 6; ++i) {
            config.matrix[i][i] = 1;
            config.matrix[i][(i + 1) % 6] = 0.25;
        }
        config.counts_per_newton = 100;
        config.counts_per_newton_metre = 5000;
        return hal::AtiNetcan(config);
    }
    static auto other_frames() noexcept { return std::array<hal::Frame, 0>{}; }
};

} // namespace dfdyn::tests::families
