// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault_kind.hpp"

namespace dfdyn::tools {

/// All frames that the devices send in `cycles` consecutive cycles are lost; commands are not.
FaultKind fault_kinds::cycles_lost() {
    return {"cycles_lost", {"cycles", "at_s"}, [](const FaultReader& reader) {
                const int cycles = reader.json().whole_number("cycles", 1, 1'000'000);
                Fault fault = reader.since(cycles * reader.loop_period_s());
                fault.act = [](Faults& faults) { faults.link.devices_silent = true; };
                return fault;
            }};
}

} // namespace dfdyn::tools
