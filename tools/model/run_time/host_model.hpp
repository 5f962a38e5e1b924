// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/dfdyn.hpp"
#include "tools/model/model.hpp"
#include "tools/model/run_time/any_input.hpp"

#include <memory>

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

/// Returns the time step (ns) that an estimator without a known sample period treats as a gap: 1.5 periods.
std::int64_t gap_ns(const TrainedModel& model);

/// Returns the largest |prediction| of each output; 0 without a bound.
std::vector<double> prediction_limits(const TrainedModel& model);

/// Returns the factor that the firmware applies to each element of ξ. For DFW it includes the weight of the
/// lag.
std::vector<double> firmware_scale(const InputModel& input);

/// Returns R in the firmware's difference form (see `to_difference_form`); k × (M+1).
std::vector<double> firmware_rows(const InputModel& input);

/// Returns ω / ℓ ordered by inputs: element (input a, feature b) at a·d + b.
std::vector<double> firmware_frequencies(const FeatureModel& features, int inputs);

/// Returns the initial weights in the order of the firmware's learner. For SPK: those of each output, then
/// those of its columns ψ.
std::vector<double> firmware_weights(const TrainedModel& model);

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
