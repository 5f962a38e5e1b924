// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"

#include <cmath>
#include <cstdint>

namespace dfdyn {

/// The physics columns ψ, one row per output, in units of that output's noise.
template <class Model>
class PhysicsColumns {
  public:
    using Scalar = typename Model::Scalar;
    using Constants = typename Model::Constants;

    explicit PhysicsColumns(const Constants& constants) noexcept
        : constants_(&constants), map_(constants.physics, constants.sizes.physics),
          psi_(Rows::zeros(extent<product(Model::outputs, Model::parameters)>(
              constants.sizes.output_count * constants.sizes.physics.column_count))) {}

    void restart() noexcept { map_.restart(); }
    [[nodiscard]] bool ready() const noexcept { return map_.ready(); }
    void push(const typename Model::Sample& sample) noexcept { map_.push(sample); }

    /// Computes ψ. Returns false, with ψ undefined, if the motion exceeds the physics' limits or a row is not
    /// finite.
    bool evaluate() noexcept {
        if (!map_.evaluate(psi_.data())) {
            return false;
        }
        bool finite = true;
        const int parameters = constants_->sizes.physics.column_count;
        for (int k = 0; k < constants_->sizes.output_count; ++k) {
            const Scalar precision = 1 / constants_->output_noise_std[k];
            for (int c = 0; c < parameters; ++c) {
                psi_[k * parameters + c] *= precision;
                finite = finite && std::isfinite(psi_[k * parameters + c]);
            }
        }
        return finite;
    }

    [[nodiscard]] const typename Model::Sizes& sizes() const noexcept { return constants_->sizes; }

    /// Returns ψ of the last `evaluate`, m × p, row-major.
    [[nodiscard]] const Scalar* data() const noexcept { return psi_.data(); }

    [[nodiscard]] static constexpr std::int64_t cost(const typename Model::Sizes& sizes) noexcept {
        return Map::cost(sizes.physics) + std::int64_t{sizes.output_count} * (1 + sizes.physics.column_count);
    }

    [[nodiscard]] static constexpr std::int64_t stack_bytes(const typename Model::Sizes& sizes) noexcept {
        return Map::stack_bytes(sizes.physics);
    }

  private:
    using Map = typename Model::Physics::template Map<Scalar, typename Model::Arm>;
    using Rows = Storage<Scalar, product(Model::outputs, Model::parameters)>;

    const Constants* constants_;
    Map map_;
    Rows psi_;
};

} // namespace dfdyn
