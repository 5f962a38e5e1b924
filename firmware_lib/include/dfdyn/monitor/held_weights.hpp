// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/storage.hpp"

namespace dfdyn {

/// What an estimator knew a while ago: two copies of its `count` weights, renewed in turn, so that the older
/// one is between one and two periods old. What it predicts differs from what is measured by all of a change,
/// also while the estimator learns it. Memory 2 `count` scalars.
template <class Scalar, int count>
class HeldWeights {
  public:
    explicit HeldWeights(Extent<count> size) noexcept
        : first_(Weights::zeros(size)), second_(Weights::zeros(size)) {}

    [[nodiscard]] const Scalar* older() const noexcept { return (newer_is_first_ ? second_ : first_).data(); }

    /// Where to write the present weights in place of the older ones; the newer ones are then the older.
    [[nodiscard]] Scalar* renew() noexcept {
        newer_is_first_ = !newer_is_first_;
        return (newer_is_first_ ? first_ : second_).data();
    }

  private:
    using Weights = Storage<Scalar, count>;
    Weights first_, second_;
    bool newer_is_first_ = false;
};

} // namespace dfdyn
