// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/text.hpp"
#include "tools/simulation/faults/fault_kind.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

const std::vector<FaultKind>& fault_catalogue() {
    using namespace fault_kinds;
    static const std::vector<FaultKind> kinds{
        friction_step(),  push(),         actuator_gain(), actuator_saturation(),
        encoder_frozen(), encoder_jump(), torque_bias(),   torque_scale(),
        frames_lost(),    cycles_lost(),  late_ticks(),    clock_jump(),
    };
    return kinds;
}

std::string fault_kind_names(const std::string& conjunction) {
    const std::vector<FaultKind>& kinds = fault_catalogue();
    std::string names;
    for (std::size_t i = 0; i < kinds.size(); ++i) {
        const bool last = i + 1 == kinds.size();
        names += i == 0 ? "" : last ? " " + conjunction + " " : ", ";
        names += kinds[i].name;
    }
    return names;
}

namespace {

constexpr double longest_fault_s = 1e6;

std::int64_t nanoseconds(double seconds) { return std::llround(seconds * 1e9); }

} // namespace

Fault FaultReader::lasting() const {
    const double from_s = within("from_s", 0, longest_fault_s, 0);
    Fault fault;
    fault.from_ns = nanoseconds(from_s);
    if (json().has("for_s")) {
        fault.until_ns = nanoseconds(from_s + json().number_within("for_s", 1e-6, longest_fault_s));
    }
    return fault;
}

Fault FaultReader::since() const {
    Fault fault;
    fault.from_ns = nanoseconds(json().number_within("at_s", 0, longest_fault_s));
    if (json().has("for_s")) {
        fault.until_ns = fault.from_ns + nanoseconds(json().number_within("for_s", 1e-6, longest_fault_s));
    }
    return fault;
}

Fault FaultReader::since(double for_s) const {
    Fault fault;
    fault.from_ns = nanoseconds(json().number_within("at_s", 0, longest_fault_s));
    fault.until_ns = fault.from_ns + nanoseconds(for_s);
    return fault;
}

std::vector<Eigen::Index> FaultReader::named_joints() const {
    if (!json().is_array("joint")) {
        return {json().whole_number("joint", 1, joint_count()) - 1};
    }
    std::vector<Eigen::Index> joints;
    for (const int joint : json().whole_numbers("joint", 1, joint_count())) {
        if (std::ranges::count(joints, joint - 1) > 0) {
            throw json().error("joint", "each joint once", std::to_string(joint) + " again");
        }
        joints.push_back(joint - 1);
    }
    return joints;
}

std::vector<Eigen::Index> FaultReader::joints() const {
    if (json().has("joint")) {
        return named_joints();
    }
    std::vector<Eigen::Index> joints;
    for (int joint = 0; joint < joint_count(); ++joint) {
        joints.push_back(joint);
    }
    return joints;
}

std::vector<Fault> read_faults(const ScenarioReader& reader, double loop_period_s) {
    std::vector<Fault> faults;
    for (const JsonReader& entry : reader.json().objects("faults", 0, 1000)) {
        const std::string name = entry.text("kind");
        const auto kind = std::ranges::find(fault_catalogue(), name, &FaultKind::name);
        if (kind == fault_catalogue().end()) {
            throw entry.error("kind", fault_kind_names("or"), in_quotes(name));
        }
        std::vector<std::string_view> fields{"kind"};
        fields.insert(fields.end(), kind->fields.begin(), kind->fields.end());
        entry.allow_only(fields);
        faults.push_back(kind->read(FaultReader({entry, reader.joint_count()}, loop_period_s)));
    }
    return faults;
}

} // namespace dfdyn::tools
