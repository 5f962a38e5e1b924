// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/text.hpp"
#include "tools/simulation/faults/fault_kind.hpp"

#include <cmath>

namespace dfdyn::tools {

/// A clock of the loop's computer is set by `by_s`. The ticks keep their schedule, because in real
/// time they follow a clock that cannot be set (CLOCK_MONOTONIC).
///
/// `clock` `wall`: the clock with which a kernel stamps frames (CLOCK_REALTIME), set while a cycle's frames
/// wait to be read. hal::SocketCanBus converts their stamps to the clock of the schedule (hal::WallClock),
/// and so does MemoryBus. `clock` `bus`: the only clock of a bus with a clock of its own, set between two
/// cycles. The stamps of frames, the time of reading and the due times of ticks jump together.
FaultKind fault_kinds::clock_jump() {
    return {"clock_jump", {"by_s", "clock", "at_s"}, [](const FaultReader& reader) {
                const std::string clock = reader.json().has("clock") ? reader.json().text("clock") : "wall";
                if (clock != "wall" && clock != "bus") {
                    throw reader.json().error("clock", "wall or bus", in_quotes(clock));
                }
                Fault fault = reader.since();
                fault.act = [set = clock == "wall" ? &LinkFaults::wall_set_ns : &LinkFaults::bus_set_ns,
                             by_ns = std::llround(1e9 * reader.json().number_within("by_s", -1, 1))](
                                Faults& faults) { faults.link.*set += by_ns; };
                return fault;
            }};
}

} // namespace dfdyn::tools
