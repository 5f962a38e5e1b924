// SPDX-License-Identifier: Apache-2.0
#include "tools/bench/memory_table.hpp"

#include "dfdyn/dfdyn.hpp"

#include <utility>

namespace dfdyn::tools {

namespace {

template <class Scalar, int... columns>
void append(std::vector<MemoryRow>& rows, const std::string& scalar,
            std::integer_sequence<int, columns...> /*sizes*/) {
    (rows.push_back({scalar, columns,
                     Estimator<Model<Scalar, Joints<6, 6>, DerivativeFreeReduced<10, 3>,
                                     RandomFourier<columns / 2>>>::footprint()}),
     ...);
}

} // namespace

std::vector<MemoryRow> memory_rows() {
    using Sizes = std::integer_sequence<int, 100, 200, 500, 1000>;
    std::vector<MemoryRow> rows;
    append<float>(rows, "float", Sizes{});
    append<double>(rows, "double", Sizes{});
    return rows;
}

} // namespace dfdyn::tools
