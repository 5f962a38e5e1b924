// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/budget.hpp"
#include "dfdyn/core/storage.hpp"
#include "dfdyn/features/cos_sin.hpp"

#include <cstdint>

namespace dfdyn {

/// Random Fourier features of the Gaussian kernel K_G = exp(-|ξ-ξ'|²/(2ℓ²)): φ = [cos(Ωξ); sin(Ωξ)]/√d, 2d
/// columns (paper, Section IV-A, with one length scale ℓ: Ω = ω/ℓ, ω ~ N(0, I)). Orthogonal random features
/// (F. X. Yu et al., 2016) are the same map with another distribution of ω; the training tool offers both.
/// Cost of `evaluate`: d·dim(ξ) multiply-adds, and d cosines and sines.
template <int d>
struct RandomFourier {
    static constexpr int identity = 1;
    static constexpr int count = d;
    static constexpr int columns = product(2, d);

    template <class Scalar, int inputs>
    struct Constants {
        /// Ω by inputs: element (input a, feature b) at a·d + b. Includes the division by the length scale.
        Storage<Scalar, product(inputs, d)> frequencies;
        Scalar amplitude; ///< 1/√d
    };

    /// Writes φ (2d values) of `xi` (one value per input). Returns false, with φ undefined, if an argument is
    /// not finite or exceeds `largest_cos_sin_argument`.
    template <class Scalar, int inputs>
    static bool evaluate(const Constants<Scalar, inputs>& constants, Extent<inputs> input_count,
                         Extent<d> feature_count, const Scalar* xi, Scalar* phi) noexcept {
        for (int b = 0; b < feature_count; ++b) {
            phi[b] = 0;
        }
        for (int a = 0; a < input_count; ++a) {
            const Scalar* frequency = constants.frequencies.data() + a * feature_count;
            for (int b = 0; b < feature_count; ++b) {
                phi[b] += frequency[b] * xi[a];
            }
        }
        return cos_sin(phi, feature_count, constants.amplitude, phi, phi + feature_count);
    }

    template <class Scalar>
    [[nodiscard]] static constexpr std::int64_t cost(int input_count, int feature_count) noexcept {
        return std::int64_t{feature_count} * input_count + cos_sin_cost<Scalar>(feature_count);
    }

    /// Returns the maximum stack bytes of `evaluate`.
    template <class Scalar>
    [[nodiscard]] static constexpr std::int64_t stack_bytes() noexcept {
        return frame_bytes + cos_sin_bytes<Scalar>;
    }
};

} // namespace dfdyn
