// SPDX-License-Identifier: Apache-2.0
#include "tools/training/physics/robot_regressor.hpp"

#include "tools/model/run_time/host_model.hpp"
#include "tools/training/physics/physics_regressor.hpp"

#include <numeric>

namespace dfdyn::tools {

namespace {

/// Returns physics with all columns selected and unscaled.
PhysicsModel whole_physics(const ChainModel& chain, const std::vector<EffectModel>& effects,
                           const std::vector<double>& output_gain) {
    PhysicsModel physics;
    physics.chain = chain;
    physics.motion.kind = InputKind::STD;
    physics.motion.derivatives = Derivatives::measured;
    physics.effects = effects;
    // of the firmware's input gate, which is not used here
    physics.motion_limit.assign(3 * chain.joints.size(), 0);
    physics.selected.resize(static_cast<std::size_t>(inertial_parameters * body_count(chain)) +
                            effects.size());
    std::iota(physics.selected.begin(), physics.selected.end(), 0);
    physics.column_scale.assign(physics.selected.size(), 1);
    physics.output_gain = output_gain;
    return physics;
}

template <class Arm>
std::unique_ptr<Regressor> regressor_of(const PhysicsModel& physics) {
    return std::make_unique<PhysicsRegressor<HostPhysics, Arm>>(host_physics<double, Arm>(physics),
                                                                host_physics_sizes<Arm>(physics));
}

} // namespace

std::unique_ptr<Regressor> robot_regressor(const ChainModel& chain, const std::vector<EffectModel>& effects,
                                           const std::vector<double>& output_gain) {
    const PhysicsModel physics = whole_physics(chain, effects, output_gain);
    return chain.sensor ? regressor_of<WrenchArm>(physics) : regressor_of<TorqueArm>(physics);
}

} // namespace dfdyn::tools
