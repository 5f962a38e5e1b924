// SPDX-License-Identifier: Apache-2.0
#include "tools/simulation/faults/fault_kind.hpp"

namespace dfdyn::tools {

namespace {

Push read_push(const FaultReader& reader) {
    const JsonReader& json = reader.json();
    Push push;
    push.force = reader.three("force_n");
    if (json.has("link")) {
        push.link = json.whole_number("link", 1, reader.joint_count()) - 1;
    }
    if (json.has("point_m")) {
        push.point = reader.three("point_m");
        if (!push.link) {
            throw json.error("point_m", "the link that the point is on", "no link");
        }
    }
    return push;
}

Fault read_push_fault(const FaultReader& reader) {
    const JsonReader& json = reader.json();
    Fault fault = reader.lasting();
    if (json.has("torque_nm") == json.has("force_n")) {
        throw json.error("force_n",
                         "either force_n, with or without link and point_m, or torque_nm, with joint",
                         json.has("force_n") ? "both" : "none");
    }
    if (json.has("torque_nm")) {
        if (json.has("link") || json.has("point_m")) {
            throw json.error("torque_nm", "a joint for a torque", "a link or a point");
        }
        fault.act = [joints = reader.named_joints(), torque = json.number("torque_nm")](Faults& faults) {
            faults.arm.load(joints).array() += torque;
        };
        return fault;
    }
    if (json.has("joint")) {
        throw json.error("force_n", "a link for a force", "a joint");
    }
    fault.act = [push = read_push(reader)](Faults& faults) { faults.arm.pushes.push_back(push); };
    return fault;
}

} // namespace

/// A constant external force on a point of a link or on the tip, or a constant torque on joints, with an
/// abrupt start and end. For smooth pulses see Contact.
FaultKind fault_kinds::push() {
    return {"push", {"force_n", "link", "point_m", "joint", "torque_nm", "from_s", "for_s"}, read_push_fault};
}

} // namespace dfdyn::tools
