// SPDX-License-Identifier: Apache-2.0
#include "tools/model/run_time/host_model.hpp"

#include "tools/model/effects.hpp"
#include "tools/model/file/model_file.hpp"
#include "tools/model/inputs/input_description.hpp"
#include "tools/model/structure.hpp"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace dfdyn::tools {

namespace {

/// `count` must be dynamic or the number of values.
template <class Scalar, int count = dynamic, class Number>
Storage<Scalar, count> converted(const std::vector<Number>& values) {
    auto storage = Storage<Scalar, count>::zeros(extent<count>(static_cast<int>(values.size())));
    for (int i = 0; i < storage.size(); ++i) {
        storage[i] = static_cast<Scalar>(values[static_cast<std::size_t>(i)]);
    }
    return storage;
}

int output_count(const TrainedModel& model) { return static_cast<int>(model.outputs.names.size()); }

/// Returns the largest |prediction| of each output; 0 without a bound.
std::vector<double> prediction_limits(const TrainedModel& model) {
    return model.limits.prediction.empty() ? std::vector<double>(model.outputs.names.size(), 0)
                                           : model.limits.prediction;
}

/// Returns the factor of each element of ξ. For DFW it includes the weight of the lag.
std::vector<double> firmware_scale(const InputModel& input) {
    std::vector<double> scale = input.scale;
    if (input_description(input.kind).weighted) {
        const auto lags = static_cast<std::size_t>(input.lags) + 1;
        for (std::size_t element = 0; element < scale.size(); ++element) {
            const std::size_t lag = element % lags;
            scale[element] *= input.rows[lag * lags + lag];
        }
    }
    return scale;
}

/// Returns R in the firmware's difference form (see `to_difference_form`); k × (M+1).
std::vector<double> firmware_rows(const InputModel& input) {
    std::vector<double> rows = input.rows;
    to_difference_form(input.rows.data(), input.rows_per_joint, input.lags, rows.data());
    return rows;
}

/// Returns ω / ℓ ordered by inputs: element (input a, feature b) at a·d + b.
std::vector<double> firmware_frequencies(const FeatureModel& features, int inputs) {
    std::vector<double> frequencies(features.omega.size());
    for (int b = 0; b < features.count; ++b) {
        for (int a = 0; a < inputs; ++a) {
            frequencies[static_cast<std::size_t>(a) * static_cast<std::size_t>(features.count) +
                        static_cast<std::size_t>(b)] =
                features.omega[static_cast<std::size_t>(b) * static_cast<std::size_t>(inputs) +
                               static_cast<std::size_t>(a)] /
                features.length_scale;
        }
    }
    return frequencies;
}

/// Returns the initial weights in the order of the learner. For SPK: those of each output, then those of its
/// columns ψ.
std::vector<double> firmware_weights(const TrainedModel& model) {
    if (!structure_of(model).coupled()) {
        return model.start.weights;
    }
    const auto columns = 2 * static_cast<std::ptrdiff_t>(model.features.count);
    const auto coupled = columns * static_cast<std::ptrdiff_t>(model.physics->selected.size());
    std::vector<double> weights;
    for (std::ptrdiff_t k = 0; k < output_count(model); ++k) {
        const auto own = model.start.weights.begin() + k * columns;
        const auto coupling = model.physics->coupling.begin() + k * coupled;
        weights.insert(weights.end(), own, own + columns);
        weights.insert(weights.end(), coupling, coupling + coupled);
    }
    return weights;
}

template <class Scalar>
Placement<Scalar> placement(const ChainModel::Frame& frame) {
    Placement<Scalar> result{};
    std::ranges::transform(frame.rotation, result.rotation, [](double x) { return static_cast<Scalar>(x); });
    std::ranges::transform(frame.translation, result.translation,
                           [](double x) { return static_cast<Scalar>(x); });
    return result;
}

template <class Scalar, int k>
typename AnyInput<k>::template Constants<Scalar, dynamic> host_input(const InputModel& input) {
    auto scale = converted<Scalar>(firmware_scale(input));
    switch (input_description(input.kind).form) {
    case InputForm::derivatives:
        if (input.derivatives == Derivatives::measured) {
            return typename StandardMeasured::template Constants<Scalar, dynamic>{std::move(scale)};
        }
        return typename Standard<dynamic>::template Constants<Scalar, dynamic>{
            static_cast<Scalar>(input.position_noise_bound), std::move(scale)};
    case InputForm::window:
        return typename DerivativeFree<dynamic>::template Constants<Scalar, dynamic>{std::move(scale)};
    default:
        return typename DerivativeFreeReduced<dynamic, k>::template Constants<Scalar, dynamic>{
            converted<Scalar>(firmware_rows(input)), std::move(scale)};
    }
}

/// Returns the columns of one of the firmware's effect types.
std::vector<EffectModel> columns_of(const PhysicsModel& physics, int identity) {
    std::vector<EffectModel> columns;
    for (const EffectModel& effect : physics.effects) {
        if (effect_kind(effect.name).identity == identity) {
            columns.push_back(effect);
        }
    }
    return columns;
}

template <class Scalar>
Storage<Scalar, dynamic> gathered(const std::vector<EffectModel>& columns, double EffectModel::*member) {
    std::vector<double> values;
    for (const EffectModel& column : columns) {
        values.push_back(column.*member);
    }
    return converted<Scalar>(values);
}

template <class Scalar, class Constants>
void set_effect(Constants& constants, const std::vector<EffectModel>& columns) {
    std::vector<int> rows;
    for (const EffectModel& column : columns) {
        rows.push_back(column.row);
    }
    constants.row = converted<std::int32_t>(rows);
    for_each_constant(constants, [&](const char* /*name*/, auto& values, double EffectModel::*member) {
        values = gathered<Scalar>(columns, member);
    });
}

template <class Scalar, class Motion, int p, class... Effects>
auto effect_constants_of(Physics<Motion, p, Effects...> /*of*/, const PhysicsModel& physics) {
    typename Physics<Motion, p, Effects...>::template EffectConstants<Scalar> result{};
    (set_effect<Scalar, typename Effects::template Constants<Scalar>>(result,
                                                                      columns_of(physics, Effects::identity)),
     ...);
    return result;
}

template <class Scalar>
typename HostPhysics::template EffectConstants<Scalar> host_effects(const PhysicsModel& physics) {
    return effect_constants_of<Scalar>(HostPhysics{}, physics);
}

template <class Start>
Start feature_start(const TrainedModel& model) {
    return {converted<float>(firmware_weights(model)), converted<float>(model.start.unit_upper),
            converted<float>(model.start.diagonal)};
}

LearnerStart<float, dynamic, 1> parameter_start(const PhysicsModel& physics) {
    return {converted<float>(physics.start.weights), converted<float>(physics.start.unit_upper),
            converted<float>(physics.start.diagonal)};
}

/// Sets the prior and the initial state of one of a model's learners.
template <class Constants>
void set_learner(Constants& learner, double prior_variance, double forgetting_factor,
                 decltype(Constants::start) start) {
    learner.prior_variance = static_cast<float>(prior_variance);
    learner.forgetting_factor = static_cast<float>(forgetting_factor);
    learner.start = start;
}

template <class Model>
void set_learners(HostConstants<Model>& host, const TrainedModel& model, bool from_prior) {
    const auto* features = from_prior ? nullptr : &host.features;
    const auto* parameters = from_prior ? nullptr : &host.parameters;
    auto& learner = host.constants.learner;
    const double lambda = model.forgetting_factor;
    if constexpr (requires { learner.common; }) {
        set_learner(learner.features, model.outputs.prior_variance, lambda, features);
        set_learner(learner.common, model.physics->prior_variance, lambda, parameters);
    } else if constexpr (requires { learner.residual; }) {
        learner.parameters_of_mean = converted<float>(model.physics->start.weights);
        set_learner(learner.residual, model.outputs.prior_variance, lambda, features);
    } else if constexpr (Model::columns == 0) {
        set_learner(learner, model.physics->prior_variance, lambda, parameters);
    } else {
        set_learner(learner, model.outputs.prior_variance, lambda, features);
    }
}

template <class Model>
typename Model::Sizes host_sizes(const TrainedModel& model) {
    typename Model::Sizes sizes{extent<Model::joints>(model.joints),
                                extent<Model::outputs>(output_count(model)),
                                extent<Model::Input::lags>(model.input.lags),
                                extent<Model::Input::features_per_joint>(model.input.rows_per_joint),
                                extent<Model::Features::count>(model.features.count),
                                {}};
    if constexpr (!std::is_same_v<typename Model::Physics, NoPhysics>) {
        sizes.physics = host_physics_sizes<typename Model::Arm>(*model.physics);
    }
    return sizes;
}

template <class Model>
void set_columns(typename Model::Constants& constants, const TrainedModel& model) {
    if constexpr (Model::columns != 0) {
        constants.input = host_input<float, dynamic>(model.input);
        constants.features.frequencies =
            converted<float>(firmware_frequencies(model.features, model.joints * model.input.rows_per_joint));
        constants.features.amplitude = 1 / std::sqrt(static_cast<float>(model.features.count));
    }
    if constexpr (!std::is_same_v<typename Model::Physics, NoPhysics>) {
        constants.physics = host_physics<float, typename Model::Arm>(*model.physics);
    }
}

/// Sets the extrapolation constants; zeros if the model has none, for the paper's predictions.
template <class Model>
void set_extrapolation(typename Model::Constants& constants, const TrainedModel& model) {
    const std::vector<double> zeros(model.outputs.names.size(), 0);
    const ExtrapolationModel none{0, zeros, zeros, {}, 1};
    const ExtrapolationModel& known = model.extrapolation ? *model.extrapolation : none;
    const bool of_parameters = !known.output_variance.empty();
    constants.extrapolation = {
        static_cast<float>(known.inverse_far_variance), converted<float, Model::outputs>(known.extra_noise),
        converted<float, Model::outputs>(known.prior_variance),
        of_parameters ? static_cast<float>(known.parameter_variance_factor) : 0.0F,
        converted<float, Model::outputs>(of_parameters ? known.output_variance : zeros)};
}

} // namespace

template <class Scalar, class Arm>
typename Arm::template Constants<Scalar> host_chain(const ChainModel& chain) {
    typename Arm::template Constants<Scalar> result{};
    result.joint = Storage<ChainJoint<Scalar>, dynamic>::zeros({static_cast<int>(chain.joints.size())});
    for (int i = 0; i < result.joint.size(); ++i) {
        const ChainModel::Joint& joint = chain.joints[static_cast<std::size_t>(i)];
        result.joint[i] = {placement<Scalar>(joint.placement), {}, joint.prismatic};
        std::ranges::transform(joint.axis, result.joint[i].axis,
                               [](double x) { return static_cast<Scalar>(x); });
    }
    std::ranges::transform(chain.gravity, result.gravity, [](double x) { return static_cast<Scalar>(x); });
    if constexpr (std::is_same_v<Arm, WrenchArm>) {
        const ChainModel::Sensor& sensor = *chain.sensor;
        result.output = {sensor.link, placement<Scalar>(sensor.placement),
                         static_cast<Scalar>(sensor.parent_to_child ? 1 : -1)};
    }
    return result;
}

std::int64_t gap_ns(const TrainedModel& model) { return std::llround(1.5e9 * model.sample_period_s); }

int body_count(const ChainModel& chain) {
    const auto joints = static_cast<int>(chain.joints.size());
    return chain.sensor ? joints - std::max(chain.sensor->link, 1) + 1 : joints;
}

std::int64_t cost_of_input(const InputModel& input, int joints) {
    switch (input_description(input.kind).form) {
    case InputForm::derivatives:
        return input.derivatives == Derivatives::measured
                   ? StandardMeasured::Map<float, dynamic>::cost(joints, 0, 3)
                   : Standard<dynamic>::Map<float, dynamic>::cost(joints, input.lags, 3);
    case InputForm::window:
        return DerivativeFree<dynamic>::Map<float, dynamic>::cost(joints, input.lags, input.rows_per_joint);
    default:
        return DerivativeFreeReduced<dynamic, dynamic>::Map<float, dynamic>::cost(joints, input.lags,
                                                                                  input.rows_per_joint);
    }
}

template <class Scalar, class Arm>
typename HostPhysics::template Constants<Scalar, Arm> host_physics(const PhysicsModel& physics) {
    return {host_chain<Scalar, Arm>(physics.chain),
            host_input<Scalar, 3>(physics.motion),
            host_effects<Scalar>(physics),
            converted<Scalar>(physics.motion_limit),
            converted<std::int32_t>(physics.selected),
            converted<Scalar>(physics.column_scale),
            converted<Scalar, Arm::outputs>(physics.output_gain)};
}

template <class Arm>
typename HostPhysics::template Sizes<Arm> host_physics_sizes(const PhysicsModel& physics) {
    return {extent<Arm::joints>(static_cast<int>(physics.chain.joints.size())),
            extent<Arm::outputs>(static_cast<int>(physics.output_gain.size())),
            extent<Arm::bodies>(body_count(physics.chain)),
            {physics.motion.lags},
            {static_cast<int>(physics.selected.size())}};
}

template <class Model>
std::unique_ptr<HostConstants<Model>> make_host_constants(const TrainedModel& model, bool from_prior) {
    auto host = std::make_unique<HostConstants<Model>>();
    host->features = feature_start<decltype(host->features)>(model);
    if (model.physics) {
        host->parameters = parameter_start(*model.physics);
    }
    typename Model::Constants& constants = host->constants;
    constants.sizes = host_sizes<Model>(model);
    constants.identity = model_identity(model);
    constants.gap_ns = gap_ns(model);
    constants.period_ns = std::llround(1e9 * model.sample_period_s);
    set_columns<Model>(constants, model);
    constants.output_offset = converted<float, Model::outputs>(model.outputs.offset);
    constants.output_noise_std = converted<float, Model::outputs>(model.outputs.noise_std);
    constants.position_limit = converted<float>(model.limits.position_rad);
    constants.output_limit = converted<float, Model::outputs>(model.limits.output);
    constants.innovation_limit = static_cast<float>(model.limits.innovation);
    constants.innovation_patience = model.limits.innovation_patience;
    constants.prediction_limit = converted<float, Model::outputs>(prediction_limits(model));
    set_learners(*host, model, from_prior);
    set_extrapolation<Model>(constants, model);
    return host;
}

template std::unique_ptr<HostConstants<HostNonparametric>> make_host_constants(const TrainedModel&, bool);
template std::unique_ptr<HostConstants<HostParametric<TorqueArm>>> make_host_constants(const TrainedModel&,
                                                                                       bool);
template std::unique_ptr<HostConstants<HostParametric<WrenchArm>>> make_host_constants(const TrainedModel&,
                                                                                       bool);
template std::unique_ptr<HostConstants<HostMean<TorqueArm>>> make_host_constants(const TrainedModel&, bool);
template std::unique_ptr<HostConstants<HostMean<WrenchArm>>> make_host_constants(const TrainedModel&, bool);
template std::unique_ptr<HostConstants<HostKernel<TorqueArm>>> make_host_constants(const TrainedModel&, bool);
template std::unique_ptr<HostConstants<HostKernel<WrenchArm>>> make_host_constants(const TrainedModel&, bool);

template TorqueArm::Constants<float> host_chain<float, TorqueArm>(const ChainModel&);
template WrenchArm::Constants<float> host_chain<float, WrenchArm>(const ChainModel&);

template HostPhysics::Constants<double, TorqueArm> host_physics<double, TorqueArm>(const PhysicsModel&);
template HostPhysics::Constants<double, WrenchArm> host_physics<double, WrenchArm>(const PhysicsModel&);
template HostPhysics::Sizes<TorqueArm> host_physics_sizes<TorqueArm>(const PhysicsModel&);
template HostPhysics::Sizes<WrenchArm> host_physics_sizes<WrenchArm>(const PhysicsModel&);

} // namespace dfdyn::tools
