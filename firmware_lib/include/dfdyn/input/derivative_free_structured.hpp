// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/input/derivative_free_reduced.hpp"

namespace dfdyn {

/// Gains and poles of input DFSR: velocity α₁ (1 - z⁻¹)/(1 - β₁ z⁻¹) q, acceleration α₂ (1 - z⁻¹)²/(1 - β₂
/// z⁻¹) q. α₁ = 1/T_s and α₂ = 1/T_s² give rad/s and rad/s² up to the filters' gains 1/(1 - β). 0 < β < 1.
template <class Scalar>
struct StructuredFilters {
    Scalar alpha1, alpha2;
    Scalar beta1, beta2;
};

/// Writes the three FIR rows of DFSR (paper, Section V-C), 3 × (M+1), row-major, M ≥ 2.
template <class Scalar>
constexpr void structured_rows(const StructuredFilters<Scalar>& filters, int lags, Scalar* rows) noexcept {
    Scalar* position = rows;
    Scalar* velocity = rows + (lags + 1);
    Scalar* acceleration = rows + 2 * (lags + 1);
    position[0] = 1;
    velocity[0] = filters.alpha1;
    acceleration[0] = filters.alpha2;
    Scalar velocity_tail = filters.alpha1 * (filters.beta1 - 1);
    Scalar acceleration_tail = filters.alpha2 * (filters.beta2 - 1) * (filters.beta2 - 1);
    for (int lag = 1; lag <= lags; ++lag) {
        position[lag] = 0;
        velocity[lag] = velocity_tail;
        velocity_tail *= filters.beta1;
        if (lag == 1) {
            acceleration[lag] = filters.alpha2 * (filters.beta2 - 2);
        } else {
            acceleration[lag] = acceleration_tail;
            acceleration_tail *= filters.beta2;
        }
    }
}

/// Input DFSR as in the paper: FIR rows of length M+1 and three features per joint (position, velocity,
/// acceleration). The rows of the constants come from `structured_rows` and `to_difference_form`.
template <int M>
struct DerivativeFreeStructured : DerivativeFreeReduced<M, 3> {
    static_assert(M == dynamic || M >= 2, "the acceleration row needs at least three positions");
    static constexpr int identity = 4;
};

} // namespace dfdyn
