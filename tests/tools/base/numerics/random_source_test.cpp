// SPDX-License-Identifier: Apache-2.0
#include "tools/base/numerics/random_source.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace tools = dfdyn::tools;

TEST_CASE("NormalSource draws the same numbers everywhere") {
    tools::NormalSource random(42);
    CHECK(random.next() == Approx(-1.3953469188475738).epsilon(1e-13));
    CHECK(random.next() == Approx(-0.019955066378464583).epsilon(1e-13));
    CHECK(random.next() == Approx(0.023391812482092045).epsilon(1e-13));
}

TEST_CASE("NormalSource is standard normal") {
    constexpr std::size_t count = 20000;
    tools::NormalSource random(3);
    std::vector<double> values(count);
    std::generate(values.begin(), values.end(), [&random] { return random.next(); });
    std::sort(values.begin(), values.end());
    double distance = 0; // Kolmogorov-Smirnov statistic
    for (std::size_t i = 0; i < count; ++i) {
        const double expected = 0.5 * std::erfc(-values[i] / std::numbers::sqrt2);
        distance = std::max(distance, std::abs(expected - static_cast<double>(i) / count));
    }
    CHECK(distance < 1.95 / std::sqrt(count)); // exceeded with probability 0.001
}

TEST_CASE("seeds and streams of NormalSource give different numbers") {
    const Eigen::MatrixXd base = tools::NormalSource(1).matrix(10, 10);
    CHECK(base == tools::NormalSource(1, 0).matrix(10, 10));
    for (const Eigen::MatrixXd& other :
         {tools::NormalSource(2).matrix(10, 10), tools::NormalSource(1, 1).matrix(10, 10),
          tools::NormalSource(1 + (std::uint64_t{1} << 32U)).matrix(10, 10)}) {
        CHECK(std::abs((base.array() * other.array()).mean()) <
              0.4); // 4 standard deviations of independent numbers
    }
}
