// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <vector>

namespace dfdyn::tools {

/// Returns the entries in the storage order of `matrix`.
template <class Derived>
std::vector<double> to_vector(const Eigen::PlainObjectBase<Derived>& matrix) {
    return {matrix.data(), matrix.data() + matrix.size()};
}

} // namespace dfdyn::tools
