// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault_kind.hpp"

namespace dfdyn::tools {

/// Each frame is lost independently with probability `share`: frames of the devices and commands of the loop.
/// Without a bus, a cycle's readings are one frame, and a command is another.
FaultKind fault_kinds::frames_lost() {
    return {"frames_lost", {"share", "from_s", "for_s"}, [](const FaultReader& reader) {
                Fault fault = reader.lasting();
                fault.act = [share = reader.json().number_within("share", 0, 1)](Faults& faults) {
                    double& lost = faults.link.share_lost;
                    lost = 1 - (1 - lost) * (1 - share);
                };
                return fault;
            }};
}

} // namespace dfdyn::tools
