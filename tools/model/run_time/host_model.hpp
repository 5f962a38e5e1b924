// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/dfdyn.hpp"
#include "tools/model/model.hpp"
#include "tools/model/run_time/any_input.hpp"

#include <memory>

namespace dfdyn::tools {

/// The physics of the firmware with sizes that are known at run time, in every effect.
using HostPhysics = Physics<AnyInput<3>, dynamic, ViscousFriction<dynamic>, CoulombFriction<dynamic>,
                            StribeckFriction<dynamic>, RotorInertia<dynamic>, JointSpring<dynamic>,
                            TorqueRipple<dynamic>, OutputOffset<dynamic>>;

using TorqueArm = Chain<dynamic, JointTorques>;
using WrenchArm = Chain<dynamic, WrenchAtSensor<dynamic>>;

/// The firmware's models with such sizes: the same estimator, the same arithmetic, on the heap.
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

/// The constants of a host model, and the starts that they point to. Stays where it was made.
template <class Model>
struct HostConstants {
    typename Model::Constants constants;
    /// SPK's features learn the columns of the physics too, so many outputs as there are at run time.
    static constexpr int feature_outputs = requires(typename Model::StructureConstants c) { c.common; }
    ? dynamic : Model::outputs;
    LearnerStart<float, dynamic, feature_outputs> features;
    LearnerStart<float, dynamic, 1> parameters;

    HostConstants() = default;
    HostConstants(const HostConstants&) = delete;
    HostConstants& operator=(const HostConstants&) = delete;
};

/// Converts a trained model of that structure to the constants of a host model. `from_prior`: without the
/// start that training computed.
template <class Model>
std::unique_ptr<HostConstants<Model>> make_host_constants(const TrainedModel& model, bool from_prior);

/// The step that is a gap for an estimator that does not know its sample period (ns): one and a half periods.
std::int64_t gap_ns(const TrainedModel& model);

/// |prediction| of each output at most; 0 where the model has no bound.
std::vector<double> prediction_limits(const TrainedModel& model);

/// The factor of each element of ξ that the firmware applies: for DFW it includes the weight of the lag.
std::vector<double> firmware_scale(const InputModel& input);

/// R in the firmware's difference form (see `to_difference_form`); k × (M+1).
std::vector<double> firmware_rows(const InputModel& input);

/// ω / ℓ by inputs: element (input a, feature b) at a·d + b.
std::vector<double> firmware_frequencies(const FeatureModel& features, int inputs);

/// Start weights as the firmware's learner holds them: for SPK those of each output, then of its columns ψ.
std::vector<double> firmware_weights(const TrainedModel& model);

/// Bodies whose parameters the outputs depend on.
int body_count(const ChainModel& chain);

/// Multiply-adds of the input map.
std::int64_t cost_of_input(const InputModel& input, int joints);

/// The geometry of a stored chain, as the firmware has it.
template <class Scalar, class Arm>
typename Arm::template Constants<Scalar> host_chain(const ChainModel& chain);

/// The constants of the physics in any scalar, in every effect: the firmware's and the tools' columns are the
/// same code.
template <class Scalar, class Arm>
typename HostPhysics::template Constants<Scalar, Arm> host_physics(const PhysicsModel& physics);

template <class Arm>
typename HostPhysics::template Sizes<Arm> host_physics_sizes(const PhysicsModel& physics);

} // namespace dfdyn::tools
