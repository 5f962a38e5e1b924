// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault_kind.hpp"

namespace dfdyn::tools {

/// The encoder repeats its last reading.
FaultKind fault_kinds::encoder_frozen() {
    return {"encoder_frozen", {"joint", "from_s", "for_s"}, [](const FaultReader& reader) {
                Fault fault = reader.lasting();
                fault.act = [joints = reader.named_joints()](Faults& faults) {
                    for (const Eigen::Index joint : joints) {
                        faults.encoders.frozen[static_cast<std::size_t>(joint)] = true;
                    }
                };
                return fault;
            }};
}

} // namespace dfdyn::tools
