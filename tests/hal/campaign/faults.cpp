// SPDX-License-Identifier: Apache-2.0
#include "tests/hal/campaign/faults.hpp"

#include "tests/hal/campaign/fault_actions.hpp"

#include <iterator>

namespace dfdyn::tests {

namespace {

constexpr std::array faults{
    Fault{1, "frames lost", 0.1, 0.3, lose_frames, 0.06},
    Fault{2, "whole cycles lost", 0.002, 0.02, lose_cycles, 0.06},
    Fault{3, "a board is silent", 0.01, 0.3, silence_board},
    Fault{4, "the sensor is silent", 0.01, 0.3, silence_sensor, 0.06},
    Fault{.number = 5,
          .name = "frames delayed",
          .shortest_s = 0.1,
          .longest_s = 0.3,
          .apply = delay_frames,
          .alters_outputs = true,
          .late_s = 2.4e-3},
    Fault{.number = 6,
          .name = "frames duplicated",
          .shortest_s = 0.1,
          .longest_s = 0.3,
          .apply = duplicate_frames,
          .alters_outputs = true,
          .late_s = 2.2e-3},
    Fault{7, "frames overtaken", 0.1, 0.3, swap_frames, 0.3},
    Fault{.number = 8,
          .name = "bits corrupted",
          .shortest_s = 0.1,
          .longest_s = 0.3,
          .apply = corrupt_bits,
          .alters_outputs = true},
    Fault{9, "positions are zero", 0.004, 0.2, zero_positions},
    Fault{10, "a board with an absolute encoder restarts", 0.03, 0.4, restart_absolute},
    Fault{.number = 11,
          .name = "a board with an incremental encoder restarts",
          .shortest_s = 0.1,
          .longest_s = 0.1,
          .apply = restart_incremental,
          .stays = true},
    Fault{12, "an encoder is frozen", 0.05, 0.3, freeze_encoder},
    Fault{13, "an effort is frozen", 0.1, 0.3, freeze_effort, 0.06, 0.05},
    Fault{14, "the sensor is frozen", 0.05, 0.3, freeze_sensor, 0.06, 0.012},
    Fault{15, "an effort is saturated", 0.01, 0.2, saturate_effort, 0.06},
    Fault{16, "the sensor is saturated", 0.01, 0.2, saturate_sensor, 0.06},
    Fault{.number = 17,
          .name = "a second sender of a joint",
          .shortest_s = 0.05,
          .longest_s = 0.3,
          .apply = second_joint,
          .late_s = 1.8e-3},
    Fault{.number = 18,
          .name = "a second sender of the sensor",
          .shortest_s = 0.05,
          .longest_s = 0.3,
          .apply = second_sensor,
          .recovery_s = 0.06,
          .alters_outputs = true},
    Fault{19, "old frames replayed", 0.05, 0.3, replay_old},
    Fault{.number = 20,
          .name = "a stamp ahead",
          .shortest_s = 0.1,
          .longest_s = 0.2,
          .apply = stamp_ahead,
          .late_s = 3e-3},
    Fault{.number = 21,
          .name = "a stamp behind",
          .shortest_s = 0.1,
          .longest_s = 0.2,
          .apply = stamp_behind,
          .early_s = 3e-3},
    Fault{22, "the clock is set back", 0.01, 0.01, clock_back},
    Fault{23, "the clock is set forward", 0.01, 0.01, clock_forward},
    Fault{24, "the clock is set by a few ms", 0.01, 0.01, clock_slightly},
    Fault{25, "bus-off", 0.01, 0.4, bus_off},
    Fault{26, "a SYNC is lost", 0.1, 0.3, lose_syncs, 0.3},
    Fault{.number = 27,
          .name = "answers later than the next SYNC",
          .shortest_s = 0.2,
          .longest_s = 0.5,
          .apply = late_answers,
          .late_s = 2e-3},
    Fault{.number = 28,
          .name = "the bus is overloaded",
          .shortest_s = 0.1,
          .longest_s = 0.4,
          .apply = overload,
          .waits_s = 30e-3},
    Fault{29, "frames of another form", 0.1, 0.3, malform, 0.06},
    Fault{30, "a babbling node", 0.05, 0.2, babble, 0.06},
    Fault{31, "a bit of the encoder is stuck", 0.05, 0.3, stick_bit},
    Fault{32, "two nodes swapped", 0.05, 0.3, swap_nodes},
};

} // namespace

bool FaultSite::wait_for_motion(std::size_t joint, double least_rad_s) {
    for (; begin_ns < end_ns; begin_ns += bus_period) {
        if (std::abs(truth.velocity(joint, seconds_of(begin_ns))) > least_rad_s) {
            return true;
        }
    }
    return false;
}

std::vector<Fault> campaign_faults(hal::Encoder encoder) {
    std::vector<Fault> of_encoder;
    std::ranges::copy_if(faults, std::back_inserter(of_encoder), [encoder](const Fault& fault) {
        return encoder != hal::Encoder::absolute || fault.apply != restart_incremental;
    });
    return of_encoder;
}

} // namespace dfdyn::tests
