// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault_kind.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

/// Each of `ticks` consecutive ticks of the loop starts `late_s` after its due time, while devices and arm
/// continue. Ticks that became due in the meantime follow immediately.
FaultKind fault_kinds::late_ticks() {
    return {"late_ticks", {"late_s", "ticks", "at_s"}, [](const FaultReader& reader) {
                const int ticks = reader.json().whole_or("ticks", 1, 1, 1'000'000);
                Fault fault = reader.since(ticks * reader.loop_period_s());
                const std::int64_t late_ns =
                    std::llround(1e9 * reader.json().number_within("late_s", 1e-6, 10));
                fault.act = [late_ns](Faults& faults) {
                    faults.link.late_ns = std::max(faults.link.late_ns, late_ns);
                };
                return fault;
            }};
}

} // namespace dfdyn::tools
