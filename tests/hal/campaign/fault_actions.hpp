// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/hal/campaign/faults.hpp"

namespace dfdyn::tests {

inline void move(Sent& sent, std::int64_t by_ns) {
    sent.true_ns += by_ns;
    sent.frame.stamp_ns += by_ns;
}

/// Faults of the transmission: bus_faults.cpp.
void lose_frames(FaultSite& site);
void lose_cycles(FaultSite& site);
void silence_board(FaultSite& site);
void silence_sensor(FaultSite& site);
void delay_frames(FaultSite& site);
void duplicate_frames(FaultSite& site);
void swap_frames(FaultSite& site);
void corrupt_bits(FaultSite& site);
void stamp_ahead(FaultSite& site);
void stamp_behind(FaultSite& site);
void clock_back(FaultSite& site);
void clock_forward(FaultSite& site);
void clock_slightly(FaultSite& site);
void bus_off(FaultSite& site);
void lose_syncs(FaultSite& site);
void late_answers(FaultSite& site);
void overload(FaultSite& site);
void malform(FaultSite& site);
void babble(FaultSite& site);

/// Faults of devices: device_faults.cpp.
void zero_positions(FaultSite& site);
void restart_absolute(FaultSite& site);
void restart_incremental(FaultSite& site);
void freeze_encoder(FaultSite& site);
void freeze_effort(FaultSite& site);
void freeze_sensor(FaultSite& site);
void saturate_effort(FaultSite& site);
void saturate_sensor(FaultSite& site);
void second_joint(FaultSite& site);
void second_sensor(FaultSite& site);
void replay_old(FaultSite& site);
void stick_bit(FaultSite& site);
void swap_nodes(FaultSite& site);

} // namespace dfdyn::tests
