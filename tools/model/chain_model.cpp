// SPDX-License-Identifier: Apache-2.0
#include "tools/model/chain_model.hpp"

#include "tools/base/text/error.hpp"
#include "tools/base/text/number.hpp"
#include "tools/base/text/text.hpp"
#include "tools/model/effects.hpp"
#include "tools/robot/firmware_chain.hpp"
#include "tools/robot/joint_unit.hpp"

#include <algorithm>
#include <set>

namespace dfdyn::tools {

namespace {

constexpr double stribeck_over_sign_velocity = 5;

ChainModel::Frame frame_of(const Eigen::Isometry3d& placement) {
    const Placement<double> same = firmware_placement<double>(placement);
    ChainModel::Frame frame;
    std::ranges::copy(same.rotation, frame.rotation.begin());
    std::ranges::copy(same.translation, frame.translation.begin());
    return frame;
}

/// Returns the number of outputs on which an effect can act.
int rows_of(const EffectKind& kind, const ChainModel& chain) {
    const auto joints = static_cast<int>(chain.joints.size());
    const EffectKind& offset = offset_kind(chain);
    if (chain.sensor ? &kind != &offset : (!kind.at_joint && &kind != &offset)) {
        throw InputError("effect " + in_quotes(kind.name) + ": expected one that " +
                         (chain.sensor ? std::string("a wrench can show (") + offset.name + ")"
                                       : "joint torques can show") +
                         ", found one that they cannot");
    }
    return chain.sensor ? 6 : joints;
}

} // namespace

ChainModel chain_model(const Robot& robot, OutputKind outputs) {
    ChainModel chain;
    for (const RobotJoint& joint : robot.joints) {
        chain.joints.push_back({joint.name,
                                frame_of(joint.placement),
                                {joint.axis.x(), joint.axis.y(), joint.axis.z()},
                                joint.prismatic});
    }
    chain.gravity = {robot.gravity.x(), robot.gravity.y(), robot.gravity.z()};
    if (outputs == OutputKind::wrench) {
        if (!robot.sensor) {
            throw InputError(robot.name + ": expected a force/torque sensor in the chain, found none "
                                          "(--ft-joint names the fixed joint that carries it)");
        }
        chain.sensor = {robot.sensor->joint, static_cast<int>(robot.sensor->link),
                        frame_of(robot.sensor->placement), robot.sensor->parent_to_child};
    }
    return chain;
}

std::vector<EffectModel> effect_models(const std::vector<std::string>& names, const ChainModel& chain,
                                       double sign_velocity) {
    std::vector<EffectModel> effects;
    std::set<std::string> seen;
    for (const std::string& name : names) {
        if (!seen.insert(name).second) {
            throw InputError("effect " + in_quotes(name) + ": expected once, found twice");
        }
        const EffectKind& kind = effect_kind(name);
        const int rows = rows_of(kind, chain);
        if (kind.needs_diagnosis()) {
            throw InputError("effect " + in_quotes(name) +
                             ": expected one whose shape needs no search, found "
                             "one whose cycles dfdyn diagnose has to find");
        }
        for (int row = 0; row < rows; ++row) {
            effects.push_back({name, row, sign_velocity, stribeck_over_sign_velocity * sign_velocity, 0, 0});
        }
    }
    return in_column_order(std::move(effects));
}

std::vector<std::string> column_names(const Robot& robot, const ChainModel& chain,
                                      const std::vector<EffectModel>& effects) {
    const OutputKind outputs = chain.sensor ? OutputKind::wrench : OutputKind::joint_torque;
    std::vector<std::string> names = parameter_names(robot, outputs);
    const std::vector<std::string> units = parameter_units(robot, outputs);
    for (std::size_t i = 0; i < names.size(); ++i) {
        names[i] += " (" + units[i] + ")";
    }
    const std::vector<std::string> axes = output_names(OutputKind::wrench, 0);
    for (const EffectModel& effect : effects) {
        const EffectKind& kind = effect_kind(effect.name);
        const std::string where = chain.sensor ? axes[static_cast<std::size_t>(effect.row)]
                                               : "joint" + std::to_string(effect.row + 1);
        std::string parameter = kind.parameter;
        if (kind.needs_diagnosis()) {
            parameter += " " + kind.found_shape(effect);
        }
        const bool prismatic = !chain.sensor && chain.joints[static_cast<std::size_t>(effect.row)].prismatic;
        names.push_back(where + " " + parameter + " (" + unit_at_joint(kind.unit, prismatic) + ")");
    }
    return names;
}

} // namespace dfdyn::tools
