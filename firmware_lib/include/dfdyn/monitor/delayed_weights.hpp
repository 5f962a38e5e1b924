// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/core/storage.hpp"

namespace dfdyn {

/// Delayed weights of an estimator: two copies of its `count` weights, refreshed alternately, so that the
/// older one is between one and two periods old. Its prediction error contains a whole change, also while the
/// estimator learns it. Memory: 2 `count` scalars.
template <class Scalar, int count>
class DelayedWeights {
  public:
    explicit DelayedWeights(Extent<count> size) noexcept
        : first_(Weights::zeros(size)), second_(Weights::zeros(size)) {}

    [[nodiscard]] const Scalar* older() const noexcept { return (newer_is_first_ ? second_ : first_).data(); }

    /// Returns the storage of the older weights, for the present ones. The newer copy then becomes the older.
    [[nodiscard]] Scalar* refresh() noexcept {
        newer_is_first_ = !newer_is_first_;
        return (newer_is_first_ ? first_ : second_).data();
    }

  private:
    using Weights = Storage<Scalar, count>;
    Weights first_, second_;
    bool newer_is_first_ = false;
};

} // namespace dfdyn
