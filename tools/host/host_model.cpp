// SPDX-License-Identifier: Apache-2.0
#include "tools/host/host_model.hpp"

#include "tools/model/model_file.hpp"

#include <cmath>
#include <type_traits>

namespace dfdyn::tools {

namespace {

template <class Scalar>
Storage<Scalar, dynamic> converted(const std::vector<double>& values) {
    auto storage = Storage<Scalar, dynamic>::zeros(Extent<dynamic>{static_cast<int>(values.size())});
    for (int i = 0; i < storage.size(); ++i) {
        storage[i] = static_cast<Scalar>(values[static_cast<std::size_t>(i)]);
    }
    return storage;
}

template <class Constants>
void set_input(Constants& constants, const InputModel& input) {
    constants.scale = converted<float>(firmware_scale(input));
    if constexpr (requires { constants.rows; }) {
        constants.rows = converted<float>(firmware_rows(input));
    }
    if constexpr (requires { constants.position_noise_bound; }) {
        constants.position_noise_bound = static_cast<float>(input.position_noise_bound);
    }
}

template <class Model>
typename Model::Sizes host_sizes(const TrainedModel& model) {
    return {extent<Model::joints>(model.joints),
            extent<Model::outputs>(static_cast<int>(model.outputs.names.size())),
            extent<Model::Input::lags>(model.input.lags),
            extent<Model::Input::features_per_joint>(model.input.rows_per_joint),
            extent<Model::Features::count>(model.features.count)};
}

} // namespace

std::int64_t gap_ns(const TrainedModel& model) { return std::llround(1.5e9 * model.sample_period_s); }

std::vector<double> firmware_scale(const InputModel& input) {
    std::vector<double> scale = input.scale;
    if (input.kind == InputKind::DFW) {
        const auto lags = static_cast<std::size_t>(input.lags) + 1;
        for (std::size_t element = 0; element < scale.size(); ++element) {
            const std::size_t lag = element % lags;
            scale[element] *= input.rows[lag * lags + lag];
        }
    }
    return scale;
}

std::vector<double> firmware_rows(const InputModel& input) {
    std::vector<double> rows = input.rows;
    to_difference_form(input.rows.data(), input.rows_per_joint, input.lags, rows.data());
    return rows;
}

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

template <class Input>
std::unique_ptr<HostConstants<HostModel<Input>>> make_host_constants(const TrainedModel& model,
                                                                     bool from_prior) {
    using Host = HostModel<Input>;
    auto host = std::make_unique<HostConstants<Host>>();
    host->start = {converted<float>(model.start.weights), converted<float>(model.start.unit_upper),
                   converted<float>(model.start.diagonal)};
    typename Host::Constants& constants = host->constants;
    constants.sizes = host_sizes<Host>(model);
    constants.identity = model_identity(model);
    constants.gap_ns = gap_ns(model);
    set_input(constants.input, model.input);
    constants.features.frequencies =
        converted<float>(firmware_frequencies(model.features, model.joints * model.input.rows_per_joint));
    constants.features.amplitude = 1 / std::sqrt(static_cast<float>(model.features.count));
    constants.output_offset = converted<float>(model.outputs.offset);
    constants.output_noise_std = converted<float>(model.outputs.noise_std);
    constants.position_limit = converted<float>(model.limits.position_rad);
    constants.output_limit = converted<float>(model.limits.output);
    constants.innovation_limit = static_cast<float>(model.limits.innovation);
    constants.innovation_patience = model.limits.innovation_patience;
    constants.learner.prior_variance = static_cast<float>(model.outputs.prior_variance);
    constants.learner.forgetting_factor = static_cast<float>(model.forgetting_factor);
    constants.learner.start = from_prior ? nullptr : &host->start;
    return host;
}

template std::unique_ptr<HostConstants<HostModel<Standard<dynamic>>>>
make_host_constants<Standard<dynamic>>(const TrainedModel&, bool);
template std::unique_ptr<HostConstants<HostModel<DerivativeFree<dynamic>>>>
make_host_constants<DerivativeFree<dynamic>>(const TrainedModel&, bool);
template std::unique_ptr<HostConstants<HostModel<DerivativeFreeWeighted<dynamic>>>>
make_host_constants<DerivativeFreeWeighted<dynamic>>(const TrainedModel&, bool);
template std::unique_ptr<HostConstants<HostModel<DerivativeFreeReduced<dynamic, dynamic>>>>
make_host_constants<DerivativeFreeReduced<dynamic, dynamic>>(const TrainedModel&, bool);
template std::unique_ptr<HostConstants<HostModel<DerivativeFreeStructured<dynamic>>>>
make_host_constants<DerivativeFreeStructured<dynamic>>(const TrainedModel&, bool);

} // namespace dfdyn::tools
