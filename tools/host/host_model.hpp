// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/dfdyn.hpp"
#include "tools/host/dynamic_storage.hpp"
#include "tools/model/model.hpp"

#include <memory>

namespace dfdyn::tools {

/// The firmware's model with sizes that are known at run time: the same estimator, the same arithmetic, on
/// the heap.
template <class Input>
using HostModel = Model<float, Joints<dynamic, dynamic>, Input, RandomFourier<dynamic>>;

/// The constants of a host model and the start they point to. Stays where it was made.
template <class Model>
struct HostConstants {
    typename Model::Constants constants;
    LearnerStart<typename Model::Scalar, Model::columns, Model::outputs> start;
};

/// Converts a trained model to the constants of a host model of the same input. `from_prior`: without the
/// start that training computed.
template <class Input>
std::unique_ptr<HostConstants<HostModel<Input>>> make_host_constants(const TrainedModel& model,
                                                                     bool from_prior);

/// The time between samples beyond which the window restarts (ns): one and a half sample periods.
std::int64_t gap_ns(const TrainedModel& model);

/// The factor of each element of ξ that the firmware applies: for DFW it includes the weight of the lag.
std::vector<double> firmware_scale(const InputModel& input);

/// R in the firmware's difference form (see `to_difference_form`); k × (M+1).
std::vector<double> firmware_rows(const InputModel& input);

/// ω / ℓ by inputs: element (input a, feature b) at a·d + b.
std::vector<double> firmware_frequencies(const FeatureModel& features, int inputs);

} // namespace dfdyn::tools
