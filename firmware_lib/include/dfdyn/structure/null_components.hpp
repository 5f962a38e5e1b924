// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/sample.hpp"

namespace dfdyn {

/// Input of a model without features (P: physics alone).
struct NoInput {
    static constexpr int identity = 0;
    static constexpr int lags = 0;
    static constexpr int features_per_joint = 0;
    template <class Scalar, int n, int m>
    using Sample = dfdyn::Sample<Scalar, n, m>;
    template <class Scalar, int n>
    struct Constants {};
};

/// Features of a model without features.
struct NoFeatures {
    static constexpr int identity = 0;
    static constexpr int count = 0;
    static constexpr int columns = 0;
    template <class Scalar, int inputs>
    struct Constants {};
};

/// Physics of a model without physics (NP: features alone).
struct NoPhysics {
    using Motion = NoInput;
    static constexpr int columns = 0;
    template <class Arm>
    struct Sizes {
        static constexpr int column_count = 0;
    };
    template <class Scalar, class Arm>
    struct Constants {};

    template <class Scalar, class Arm>
    static constexpr std::uint32_t identity_of(const Constants<Scalar, Arm>& /*constants*/) noexcept {
        return 0;
    }
};

} // namespace dfdyn
