// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/learner/ud_covariance.hpp"
#include "dfdyn/sample.hpp"

#include <cstdint>

namespace dfdyn {

/// An arm of which only the sizes are known: n joints, m outputs.
template <int n, int m>
struct Joints {
    static constexpr int joints = n;
    static constexpr int outputs = m;
};

/// Model NP of the paper (eq. modello_approx without the rigid body): the columns are the features alone, the
/// same for every output, learned by one learner.
template <template <class Scalar, int columns, int outputs> class LearnerForm = UdCovariance>
struct Nonparametric {
    template <class Scalar, int columns, int outputs>
    using Learner = LearnerForm<Scalar, columns, outputs>;
};

/// A model is a composition: scalar, arm, input, features, structure. `Constants` is what `dfdyn train`
/// writes; it can be a `constexpr` object in flash and must outlive the estimators that refer to it.
template <class ScalarType, class ArmType, class InputType, class FeatureType,
          class StructureType = Nonparametric<>>
struct Model {
    using Scalar = ScalarType;
    using Arm = ArmType;
    using Input = InputType;
    using Features = FeatureType;
    using Structure = StructureType;

    static constexpr int joints = Arm::joints;
    static constexpr int outputs = Arm::outputs;
    static constexpr int inputs = product(joints, Input::features_per_joint);
    static constexpr int columns = Features::columns;

    using InputMap = typename Input::template Map<Scalar, joints>;
    using InputConstants = typename Input::template Constants<Scalar, joints>;
    using FeatureConstants = typename Features::template Constants<Scalar, inputs>;
    using Learner = typename Structure::template Learner<Scalar, columns, outputs>;
    using Sample = typename Input::template Sample<Scalar, joints, outputs>;

    /// Empty for a firmware model: every size is a template argument.
    struct Sizes {
        [[no_unique_address]] Extent<joints> joint_count{};
        [[no_unique_address]] Extent<outputs> output_count{};
        [[no_unique_address]] Extent<Input::lags> lag_count{};
        [[no_unique_address]] Extent<Input::features_per_joint> features_per_joint{};
        [[no_unique_address]] Extent<Features::count> feature_count{};

        [[nodiscard]] constexpr Extent<inputs> input_count() const noexcept {
            return extent<inputs>(joint_count * features_per_joint);
        }
        [[nodiscard]] constexpr Extent<columns> column_count() const noexcept {
            return extent<columns>(2 * feature_count);
        }
    };

    struct Constants {
        [[no_unique_address]] Sizes sizes;
        std::uint32_t identity; ///< differs between models: a snapshot of one is not restored into another
        std::int64_t gap_ns;    ///< a longer time between two samples is a gap; about 1.5 sample periods
        InputConstants input;
        FeatureConstants features;
        Storage<Scalar, outputs> output_offset;    ///< y = offset + noise_std (φ'w + e), e ~ N(0, 1)
        Storage<Scalar, outputs> output_noise_std; ///< > 0, in the output's unit
        Storage<Scalar, joints> position_limit;    ///< |q_i| beyond it is refused (rad)
        Storage<Scalar, outputs> output_limit;     ///< |y_k| beyond it is not learned
        Scalar innovation_limit; ///< samples with a larger normalised innovation squared are not learned; > 0
        std::int32_t innovation_patience; ///< but after so many of them in a row they are; ≥ 0
        LearnerConstants<Scalar, columns, outputs> learner;
    };
};

} // namespace dfdyn
