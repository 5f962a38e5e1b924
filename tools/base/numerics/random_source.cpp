// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/random_source.hpp"

#include <cmath>
#include <numbers>

namespace dfdyn::tools {

NormalSource::NormalSource(std::uint64_t seed, std::uint32_t stream) {
    std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U), stream};
    engine_.seed(sequence);
}

double NormalSource::uniform() {
    constexpr double step = 0x1p-53;
    return static_cast<double>((engine_() >> 11U) + 1U) * step;
}

double NormalSource::next() {
    if (has_spare_) {
        has_spare_ = false;
        return spare_;
    }
    const double radius = std::sqrt(-2 * std::log(uniform()));
    const double angle = 2 * std::numbers::pi * uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
}

Eigen::MatrixXd NormalSource::matrix(Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd result(rows, columns);
    for (Eigen::Index row = 0; row < rows; ++row) {
        for (Eigen::Index column = 0; column < columns; ++column) {
            result(row, column) = next();
        }
    }
    return result;
}

} // namespace dfdyn::tools
