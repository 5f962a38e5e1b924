// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault_kind.hpp"

namespace dfdyn::tools {

/// The actuators' torque is `factor` times the command, as with a wrong torque constant or a hot or weak
/// magnet.
FaultKind fault_kinds::actuator_gain() {
    return {"actuator_gain", {"joint", "factor", "from_s", "for_s"}, [](const FaultReader& reader) {
                Fault fault = reader.lasting();
                fault.act = [joints = reader.joints(),
                             factor = reader.json().number_within("factor", -10, 10)](Faults& faults) {
                    faults.arm.actuator_gain(joints) *= factor;
                };
                return fault;
            }};
}

} // namespace dfdyn::tools
