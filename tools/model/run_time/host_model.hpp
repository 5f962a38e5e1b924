// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/dfdyn.hpp"
#include "tools/model/model.hpp"
#include "tools/model/run_time/any_input.hpp"
#include "tools/model/structure.hpp"

#include <memory>
#include <type_traits>

namespace dfdyn::tools {

/// The firmware's physics with all effects and with sizes known at run time.
using HostPhysics = Physics<AnyInput<3>, dynamic, ViscousFriction<dynamic>, CoulombFriction<dynamic>,
                            StribeckFriction<dynamic>, RotorInertia<dynamic>, JointSpring<dynamic>,
                            TorqueRipple<dynamic>, OutputOffset<dynamic>>;

using TorqueArm = Chain<dynamic, JointTorques>;
using WrenchArm = Chain<dynamic, WrenchAtSensor<dynamic>>;

/// The firmware's models with sizes known at run time: the same estimator and arithmetic, in heap memory.
using HostNonparametric =
    Model<float, Joints<dynamic, dynamic>, AnyInput<dynamic>, RandomFourier<dynamic>, Nonparametric<>>;
template <class Arm>
using HostParametric = Model<float, Arm, NoInput, NoFeatures, Parametric<HostPhysics>>;
template <class Arm>
using HostMean =
    Model<float, Arm, AnyInput<dynamic>, RandomFourier<dynamic>, SemiparametricMean<HostPhysics>>;
template <class Arm>
using HostKernel =
    Model<float, Arm, AnyInput<dynamic>, RandomFourier<dynamic>, SemiparametricKernel<HostPhysics>>;

/// The constants of a host model and the initial states to which they point. Not movable.
template <class Model>
struct HostConstants {
    typename Model::Constants constants;
    /// SPK: the features also learn the physics' columns, so the number of outputs is known at run time only.
    static constexpr int feature_outputs = requires(typename Model::StructureConstants c) { c.common; }
    ? dynamic : Model::outputs;
    LearnerStart<float, dynamic, feature_outputs> features;
    LearnerStart<float, dynamic, 1> parameters;

    HostConstants() = default;
    HostConstants(const HostConstants&) = delete;
    HostConstants& operator=(const HostConstants&) = delete;
};

/// Converts a trained model of this structure to the constants of a host model. `from_prior`: without the
/// initial state from training.
template <class Model>
std::unique_ptr<HostConstants<Model>> make_host_constants(const TrainedModel& model, bool from_prior);

/// Calls `use(std::type_identity<Model>{})` with the host model of a trained model's structure and outputs.
template <class Use>
auto with_host_type(const TrainedModel& model, const Use& use) {
    const Structure& structure = structure_of(model);
    const auto with_arm = [&]<class Arm>(std::type_identity<Arm> /*type*/) {
        if (!structure.features) {
            return use(std::type_identity<HostParametric<Arm>>{});
        }
        return structure.coupled() ? use(std::type_identity<HostKernel<Arm>>{})
                                   : use(std::type_identity<HostMean<Arm>>{});
    };
    if (!model.physics) {
        return use(std::type_identity<HostNonparametric>{});
    }
    return model.physics->chain.sensor ? with_arm(std::type_identity<WrenchArm>{})
                                       : with_arm(std::type_identity<TorqueArm>{});
}

/// Calls `use(name, values, member)` for each member of an effect's constants except `row`: with its name,
/// one value per column, and the member of EffectModel.
template <class Constants, class Use>
void for_each_constant(Constants& constants, const Use& use) {
    if constexpr (requires { constants.sign_velocity; }) {
        use("sign_velocity", constants.sign_velocity, &EffectModel::sign_velocity);
    }
    if constexpr (requires { constants.stribeck_velocity; }) {
        use("stribeck_velocity", constants.stribeck_velocity, &EffectModel::stribeck_velocity);
    }
    if constexpr (requires { constants.cycles_per_rev; }) {
        use("cycles_per_rev", constants.cycles_per_rev, &EffectModel::cycles_per_rev);
        use("phase", constants.phase, &EffectModel::phase);
    }
}

/// Returns the time step (ns) that an estimator without a known sample period treats as a gap: 1.5 periods.
std::int64_t gap_ns(const TrainedModel& model);

/// Returns the number of bodies whose parameters influence the outputs.
int body_count(const ChainModel& chain);

/// Returns the number of multiply-adds of the input map.
std::int64_t cost_of_input(const InputModel& input, int joints);

/// Returns the geometry of a stored chain in the firmware's form.
template <class Scalar, class Arm>
typename Arm::template Constants<Scalar> host_chain(const ChainModel& chain);

/// Returns the constants of the physics with all effects, in any scalar type. The firmware and the tools
/// compute the columns with the same code.
template <class Scalar, class Arm>
typename HostPhysics::template Constants<Scalar, Arm> host_physics(const PhysicsModel& physics);

template <class Arm>
typename HostPhysics::template Sizes<Arm> host_physics_sizes(const PhysicsModel& physics);

} // namespace dfdyn::tools
