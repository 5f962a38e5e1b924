// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/device/icub_strain.hpp"

namespace dfdyn::tests::families {

struct icub_strain {
    static constexpr const char* dbc = "icub_strain.dbc";

    static auto sensor() noexcept { return hal::icub::StrainBoard(0x0D); }
    static auto other_frames() noexcept {
        std::array<hal::Frame, 6> full_scales;
        for (int channel = 0; channel < 6; ++channel) {
            full_scales[static_cast<std::size_t>(channel)] =
                sensor().encode_full_scale(channel, channel < 3 ? 300 : 10);
        }
        return full_scales;
    }
};

} // namespace dfdyn::tests::families
