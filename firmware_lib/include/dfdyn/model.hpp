// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/extrapolation.hpp"
#include "dfdyn/sample.hpp"
#include "dfdyn/structure/nonparametric.hpp"

#include <cstdint>
#include <type_traits>

namespace dfdyn {

/// An arm with n joints and m outputs and no known geometry. `Chain` adds the geometry.
template <int n, int m>
struct Joints {
    static constexpr int joints = n;  ///< joints of the arm, or `dynamic`
    static constexpr int outputs = m; ///< torques, currents or wrench components, or `dynamic`
};

namespace detail {

/// Sample type that both the input and the physics can use: the larger of their two types.
template <class Input, class Motion, class Scalar, int n, int m>
using SampleOf = std::conditional_t<
    std::is_same_v<typename Motion::template Sample<Scalar, n, m>, dfdyn::Sample<Scalar, n, m>>,
    typename Input::template Sample<Scalar, n, m>, typename Motion::template Sample<Scalar, n, m>>;

} // namespace detail

/// A model is a composition of scalar, arm, input, features and structure. `dfdyn train` writes its
/// `Constants`, which can be a `constexpr` object in flash and must outlive the estimators that refer to it.
template <class ScalarType, class ArmType, class InputType, class FeatureType,
          class StructureType = Nonparametric<>>
struct Model {
    using Scalar = ScalarType;       ///< float or double
    using Arm = ArmType;             ///< `Joints` or `Chain`
    using Input = InputType;         ///< last positions to ξ: `DerivativeFreeReduced`, `Standard`, …
    using Features = FeatureType;    ///< ξ to φ: `RandomFourier`
    using Structure = StructureType; ///< φ, ψ or both: `Nonparametric`, `SemiparametricKernel`, …
    using Physics = typename Structure::Physics; ///< rigid body and effects; `NoPhysics` if there are none

    static constexpr int joints = Arm::joints;                                ///< n
    static constexpr int outputs = Arm::outputs;                              ///< m
    static constexpr int inputs = product(joints, Input::features_per_joint); ///< n·k, size of ξ
    static constexpr int columns = Features::columns;                         ///< 2d
    static constexpr int parameters = Physics::columns;                       ///< p

    /// Rows of R and scales.
    using InputConstants = typename Input::template Constants<Scalar, joints>;
    /// Frequencies ω, divided by the length scale.
    using FeatureConstants = typename Features::template Constants<Scalar, inputs>;
    /// Geometry, selected columns and their scales.
    using PhysicsConstants = typename Physics::template Constants<Scalar, Arm>;
    /// Initial state of the learner and its forgetting.
    using StructureConstants = typename Structure::template Constants<Scalar, columns, outputs>;
    /// Positions and outputs of one tick; with velocities and accelerations where input or physics need them.
    using Sample = detail::SampleOf<Input, typename Physics::Motion, Scalar, joints, outputs>;

    /// Empty for a firmware model, where every size is a template argument.
    struct Sizes {
        [[no_unique_address]] Extent<joints> joint_count{};                           ///< n
        [[no_unique_address]] Extent<outputs> output_count{};                         ///< m
        [[no_unique_address]] Extent<Input::lags> lag_count{};                        ///< M
        [[no_unique_address]] Extent<Input::features_per_joint> features_per_joint{}; ///< k
        [[no_unique_address]] Extent<Features::count> feature_count{};                ///< d
        [[no_unique_address]] typename Physics::template Sizes<Arm> physics{};        ///< bodies, parameters

        /// Returns the size of ξ, n·k.
        [[nodiscard]] constexpr Extent<inputs> input_count() const noexcept {
            return extent<inputs>(joint_count * features_per_joint);
        }
        /// Returns the number of columns, 2d.
        [[nodiscard]] constexpr Extent<columns> column_count() const noexcept {
            return extent<columns>(2 * feature_count);
        }
    };

    /// A trained model: all that an estimator needs besides its state.
    struct Constants {
        [[no_unique_address]] Sizes sizes; ///< empty for a firmware model
        /// Differs between models: a snapshot of one model is not restored into another.
        std::uint32_t identity;
        /// Without a period: a longer time between two samples is a gap.
        std::int64_t gap_ns;
        /// Nominal sample period; with it, `SampleClock` decides on gaps.
        std::int64_t period_ns = 0;
        [[no_unique_address]] InputConstants input;      ///< last positions to ξ
        [[no_unique_address]] FeatureConstants features; ///< ξ to φ
        [[no_unique_address]] PhysicsConstants physics;  ///< motion to ψ
        Storage<Scalar, outputs> output_offset;    ///< y = offset + noise_std (prediction + e), e ~ N(0, 1)
        Storage<Scalar, outputs> output_noise_std; ///< > 0, in the output's unit
        Storage<Scalar, joints> position_limit; ///< |q_i| beyond it is refused (rad; m for prismatic joints)
        Storage<Scalar, outputs> output_limit;  ///< |y_k| beyond it is not learned
        /// Normalised innovation squared beyond which a sample contradicts the model (see `InnovationGate`);
        /// > 0.
        Scalar innovation_limit;
        /// Net number of contradicting samples that indicate a change of the arm; ≥ 0.
        std::int32_t innovation_patience;
        /// Predictions are limited to ±`prediction_limit` (the output's unit). 0 or absent: no limit.
        Storage<Scalar, outputs> prediction_limit{};
        StructureConstants learner; ///< initial weights and covariance, forgetting
        ExtrapolationConstants<Scalar, outputs> extrapolation{}; ///< all zero: as in the paper
    };
};

} // namespace dfdyn
