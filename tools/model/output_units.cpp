// SPDX-License-Identifier: Apache-2.0
#include "tools/model/output_units.hpp"

#include "tools/robot/joint_unit.hpp"

namespace dfdyn::tools {

std::vector<std::string> output_units(const std::vector<std::string>& names, const ChainModel* chain) {
    std::vector<std::string> units;
    for (std::size_t output = 0; output < names.size(); ++output) {
        const bool at_joint = chain != nullptr && !chain->sensor && output < chain->joints.size();
        const bool force = names[output].starts_with('f') || (at_joint && chain->joints[output].prismatic);
        units.push_back(names[output].starts_with('i') ? "A" : unit_at_joint("N·m", force));
    }
    return units;
}

std::vector<std::string> output_units(const TrainedModel& model) {
    return output_units(model.outputs.names, model.physics ? &model.physics->chain : nullptr);
}

} // namespace dfdyn::tools
