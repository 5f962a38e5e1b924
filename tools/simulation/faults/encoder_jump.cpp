// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault_kind.hpp"

namespace dfdyn::tools {

/// The encoder's reading jumps by `rad`, as after lost counts or a slip of the coupling; with `for_s`, a
/// temporary error.
FaultKind fault_kinds::encoder_jump() {
    return {"encoder_jump", {"joint", "rad", "at_s", "for_s"}, [](const FaultReader& reader) {
                Fault fault = reader.since();
                fault.act = [joints = reader.named_joints(),
                             jump = reader.json().number_within("rad", -1e3, 1e3)](Faults& faults) {
                    faults.encoders.jump(joints).array() += jump;
                };
                return fault;
            }};
}

} // namespace dfdyn::tools
