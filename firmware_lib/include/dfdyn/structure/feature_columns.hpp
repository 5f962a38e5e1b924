// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"

#include <algorithm>
#include <cstdint>

namespace dfdyn {

/// The feature columns φ, common to all outputs: the input map over the last positions, followed by the
/// features.
template <class Model>
class FeatureColumns {
  public:
    using Scalar = typename Model::Scalar;
    using Constants = typename Model::Constants;

    explicit FeatureColumns(const Constants& constants) noexcept
        : constants_(&constants), map_(constants.input, constants.sizes.joint_count,
                                       constants.sizes.lag_count, constants.sizes.features_per_joint),
          xi_(Inputs::zeros(constants.sizes.input_count())),
          phi_(Columns::zeros(constants.sizes.column_count())) {}

    void restart() noexcept { map_.restart(); }
    [[nodiscard]] bool ready() const noexcept { return map_.ready(); }
    void push(const typename Model::Sample& sample) noexcept { map_.push(sample); }

    /// Computes φ. Returns false, with φ undefined, if an input is far outside the training data.
    bool evaluate() noexcept {
        const typename Model::Sizes& sizes = constants_->sizes;
        map_.evaluate(xi_.data());
        return Model::Features::template evaluate<Scalar, Model::inputs>(
            constants_->features, sizes.input_count(), sizes.feature_count, xi_.data(), phi_.data());
    }

    [[nodiscard]] const typename Model::Sizes& sizes() const noexcept { return constants_->sizes; }

    /// Returns φ of the last `evaluate`, 2d values.
    [[nodiscard]] const Scalar* data() const noexcept { return phi_.data(); }

    [[nodiscard]] static constexpr std::int64_t cost(const typename Model::Sizes& sizes) noexcept {
        return Map::cost(sizes.joint_count, sizes.lag_count, sizes.features_per_joint) +
               Model::Features::template cost<Scalar>(sizes.input_count(), sizes.feature_count);
    }

    [[nodiscard]] static constexpr std::int64_t stack_bytes() noexcept {
        return std::max(Map::stack_bytes(), Model::Features::template stack_bytes<Scalar>());
    }

  private:
    using Map = typename Model::Input::template Map<Scalar, Model::joints>;
    using Inputs = Storage<Scalar, Model::inputs>;
    using Columns = Storage<Scalar, Model::columns>;

    const Constants* constants_;
    Map map_;
    Inputs xi_;
    Columns phi_;
};

} // namespace dfdyn
