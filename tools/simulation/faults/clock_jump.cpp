// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/text.hpp"
#include "tools/simulation/faults/fault_kind.hpp"

#include <cmath>

namespace dfdyn::tools {

/// A clock of the loop's computer is set by `by_s`. Ticks keep their pace: that of real time is kept by a
/// clock that nobody sets (CLOCK_MONOTONIC).
///
/// `clock` `wall`: the one by which a kernel stamps frames (CLOCK_REALTIME), while those of a cycle wait to
/// be read. hal::SocketCanBus moves their stamps onto the clock of the pace (hal::WallClock); so does
/// MemoryBus. `clock` `bus`: the only clock of a bus that has one, between two cycles: the stamps of frames,
/// the time of reading and that for which a tick is due jump together.
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
