// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault_kind.hpp"

namespace dfdyn::tools {

/// Multiplies the torque sensor's reading, including its noise, by `factor`.
FaultKind fault_kinds::torque_scale() {
    return {"torque_scale", {"joint", "factor", "from_s", "for_s"}, [](const FaultReader& reader) {
                Fault fault = reader.lasting();
                fault.act = [joints = reader.joints(),
                             factor = reader.json().number_within("factor", -100, 100)](Faults& faults) {
                    faults.torque_sensor.factor(joints) *= factor;
                };
                return fault;
            }};
}

} // namespace dfdyn::tools
