// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/sample.hpp"

#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

namespace dfdyn::tests {

inline constexpr double period_s = 1e-3;
inline constexpr std::int64_t period_ns = 1'000'000;

/// Positions of n joints over time, one row per sample, oldest first.
using Positions = std::vector<std::vector<double>>;

/// Random independent positions within ±3 rad.
inline Positions random_positions(std::mt19937_64& engine, int count, int joints) {
    std::uniform_real_distribution<double> position(-3, 3);
    Positions rows(static_cast<std::size_t>(count), std::vector<double>(static_cast<std::size_t>(joints)));
    for (std::vector<double>& row : rows) {
        for (double& value : row) {
            value = position(engine);
        }
    }
    return rows;
}

/// Smooth positions of two joints at 1 kHz.
inline Positions smooth_positions(int count) {
    Positions rows;
    for (int t = 0; t < count; ++t) {
        const double time_s = period_s * t;
        rows.push_back({2.5 + 0.4 * std::sin(3 * time_s), -1 + std::sin(2 * time_s) * std::cos(5 * time_s)});
    }
    return rows;
}

/// Returns sample number `index` of `positions`, without outputs.
template <class Scalar, int n>
Sample<Scalar, n, 1> sample_at(const Positions& positions, int index) {
    Sample<Scalar, n, 1> sample{};
    sample.time_ns = index * period_ns;
    for (int i = 0; i < n; ++i) {
        sample.position[i] =
            static_cast<Scalar>(positions[static_cast<std::size_t>(index)][static_cast<std::size_t>(i)]);
    }
    return sample;
}

/// Returns the inputs ξ of a map after the last of `positions`.
template <class Map, class Scalar, int n>
std::vector<Scalar> inputs_after(Map& map, const Positions& positions, int count) {
    for (int t = 0; t < static_cast<int>(positions.size()); ++t) {
        map.push(sample_at<Scalar, n>(positions, t));
    }
    std::vector<Scalar> xi(static_cast<std::size_t>(count));
    map.evaluate(xi.data());
    return xi;
}

/// Returns true if a map is ready after exactly `samples` samples, also after a restart.
template <class Scalar, int n, class Map>
bool ready_after(Map& map, int samples) {
    bool right = true;
    for (int turn = 0; turn < 2; ++turn) {
        map.restart();
        for (int t = 0; t < samples + 5; ++t) {
            right = right && map.ready() == (t >= samples);
            map.push(sample_at<Scalar, n>(Positions{std::vector<double>(n, 0.1)}, 0));
        }
    }
    return right;
}

} // namespace dfdyn::tests
