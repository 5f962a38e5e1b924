// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault_kind.hpp"

#include <algorithm>

namespace dfdyn::tools {

/// The actuators' torque is limited to ± `limit_nm`, as in a derated drive.
FaultKind fault_kinds::actuator_saturation() {
    return {"actuator_saturation", {"joint", "limit_nm", "from_s", "for_s"}, [](const FaultReader& reader) {
                Fault fault = reader.lasting();
                fault.act = [joints = reader.joints(),
                             limit = reader.json().number_within("limit_nm", 0, 1e6)](Faults& faults) {
                    for (const Eigen::Index joint : joints) {
                        double& most = faults.arm.actuator_limit[joint];
                        most = std::min(most, limit);
                    }
                };
                return fault;
            }};
}

} // namespace dfdyn::tools
