// SPDX-License-Identifier: Apache-2.0
#pragma once

// Optional views of the library's numbers as Eigen matrices, without a copy. A view is valid as long as the
// object that it refers to. The library itself does not need Eigen.
#include "dfdyn/core/storage.hpp"
#include "dfdyn/learner/learner.hpp"

#include <Eigen/Core>

#include <cstddef>

namespace dfdyn {

static_assert(storage_alignment == 32, "Eigen::Aligned32 below is this alignment");

/// A column of `count` numbers, in the unit of the numbers.
template <class Scalar, int count>
using VectorView = Eigen::Map<Eigen::Vector<Scalar, count>, Eigen::Aligned32>;
template <class Scalar, int count>
using ConstVectorView = Eigen::Map<const Eigen::Vector<Scalar, count>, Eigen::Aligned32>;

/// Returns a view of the numbers of a sample (`position`, `output`, `velocity`, `acceleration`) or an
/// estimate
/// (`prediction`, `standard_deviation`, `innovation`): `count` × 1, in their unit. O(1).
template <class Scalar, int count>
VectorView<Scalar, count> view(Storage<Scalar, count>& numbers) noexcept {
    return VectorView<Scalar, count>(numbers.data());
}
template <class Scalar, int count>
ConstVectorView<Scalar, count> view(const Storage<Scalar, count>& numbers) noexcept {
    return ConstVectorView<Scalar, count>(numbers.data());
}

/// Rejects temporary objects, whose view would dangle.
template <class Scalar, int count>
void view(const Storage<Scalar, count>&& numbers) = delete;

/// View of weights, m × p: one row per output, with a stride between the rows.
template <class Scalar, int p, int m>
using WeightsView = Eigen::Map<const Eigen::Matrix<Scalar, m, p, Eigen::RowMajor>, Eigen::Unaligned,
                               Eigen::OuterStride<Eigen::Dynamic>>;

/// Returns a view of the weights of `estimator.regression().learner()` of a nonparametric model: m × 2d, in
/// units of each output's noise. Read it when the learner is `idle()`: learning changes the weights. O(1).
template <template <class, int, int> class Form, class Scalar, int p, int m>
requires Learner<Form<Scalar, p, m>, Scalar> &&
    (p > 1) WeightsView<Scalar, p, m> view_weights(const Form<Scalar, p, m>& learner) noexcept {
    const auto stride = m == 1 ? std::ptrdiff_t{p} : learner.weights(1) - learner.weights(0);
    return WeightsView<Scalar, p, m>(learner.weights(0), Eigen::OuterStride<Eigen::Dynamic>(stride));
}

} // namespace dfdyn
