// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault_kind.hpp"

namespace dfdyn::tools {

/// Multiplies levels and viscous friction by `factor`, as cold grease or a dragging brake does.
FaultKind fault_kinds::friction_step() {
    return {"friction_step", {"joint", "factor", "from_s", "for_s"}, [](const FaultReader& reader) {
                Fault fault = reader.lasting();
                fault.act = [joints = reader.joints(),
                             factor = reader.json().number_within("factor", 0, 1000)](Faults& faults) {
                    faults.arm.friction_factor(joints) *= factor;
                };
                return fault;
            }};
}

} // namespace dfdyn::tools
