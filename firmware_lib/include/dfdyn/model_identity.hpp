// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/checksum.hpp"
#include "dfdyn/input/input_identity.hpp"
#include "dfdyn/model.hpp"

#include <cstdint>
#include <span>

namespace dfdyn {

/// Returns a checksum over the kinds of all parts of a model, its sizes, its scalar and `constants.identity`,
/// which alone may be equal for different models. A snapshot contains the checksum.
template <class Model>
[[nodiscard]] std::uint32_t model_identity(const typename Model::Constants& constants,
                                           const typename Model::Sizes& sizes) noexcept {
    using Learner = typename Model::Structure::template Regression<Model>::Learner;
    const std::int32_t parts[] = {sizes.joint_count,
                                  sizes.output_count,
                                  sizes.lag_count,
                                  sizes.features_per_joint,
                                  sizes.feature_count,
                                  sizes.physics.column_count,
                                  sizeof(typename Model::Scalar),
                                  Model::Structure::identity,
                                  Learner::identity,
                                  Model::Features::identity,
                                  input_identity<typename Model::Input>(constants.input)};
    const std::uint32_t kinds = crc32(std::as_bytes(std::span(parts)), constants.identity);
    return crc32_of(Model::Physics::identity_of(constants.physics), kinds);
}

} // namespace dfdyn
