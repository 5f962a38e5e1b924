// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault_kind.hpp"

namespace dfdyn::tools {

/// The torque sensor's reading is too large by `nm`.
FaultKind fault_kinds::torque_bias() {
    return {"torque_bias", {"joint", "nm", "from_s", "for_s"}, [](const FaultReader& reader) {
                Fault fault = reader.lasting();
                fault.act = [joints = reader.joints(), bias = reader.json().number_within("nm", -1e6, 1e6)](
                                Faults& faults) { faults.torque_sensor.bias(joints).array() += bias; };
                return fault;
            }};
}

} // namespace dfdyn::tools
