// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/reason.hpp"

#include "tests/support/catch.hpp"

#include <set>
#include <string>
#include <utility>

namespace {

/// Numbers and names of the reasons in logs. They must never change.
constexpr std::pair<int, const char*> published_reasons[] = {
    {0, "ok"},
    {1, "waiting_for_position"},
    {2, "waiting_for_output"},
    {3, "qualifying"},
    {4, "waiting_for_full_scale"},
    {5, "history_too_short"},
    {6, "output_not_new"},
    {7, "no_output"},
    {32, "position_stale"},
    {33, "output_stale"},
    {34, "position_gap"},
    {35, "output_gap"},
    {36, "output_incomplete"},
    {37, "output_saturated"},
    {38, "output_frozen"},
    {39, "position_out_of_range"},
    {40, "output_out_of_range"},
    {41, "full_scale_implausible"},
    {42, "encoder_fault"},
    {43, "device_fault"},
    {44, "device_not_operational"},
    {45, "heartbeat_missing"},
    {46, "clock_jumped"},
    {47, "time_not_increasing"},
    {48, "frames_lost"},
    {49, "bus_off"},
    {50, "interface_down"},
    {51, "wrong_length"},
    {52, "wrong_frame_type"},
    {53, "id_collision"},
    {60, "full_scale_contradicted"},
    {61, "device_restarted"},
    {62, "position_missing"},
    {63, "output_missing"},
    {64, "position_jump"},
    {65, "position_lost"},
    {66, "position_frozen"},
    {67, "sync_unknown"},
    {68, "output_jump"},
    {69, "frame_waited"},
    {70, "velocity_contradicts"},
};

} // namespace

TEST_CASE("the HAL's reasons keep their numbers and names") {
    std::set<int> known;
    for (const auto& [number, text] : published_reasons) {
        CHECK(dfdyn::hal::name(static_cast<dfdyn::hal::Reason>(number)) == std::string(text));
        CHECK(dfdyn::hal::is_fault(static_cast<dfdyn::hal::Reason>(number)) == (number >= 32));
        known.insert(number);
    }
    for (int number = 0; number < 256; ++number) {
        if (!known.contains(number)) {
            CHECK(dfdyn::hal::name(static_cast<dfdyn::hal::Reason>(number)) == std::string("unknown"));
        }
    }
    CHECK(dfdyn::hal::reason_count == *known.rbegin() + 1);
}
