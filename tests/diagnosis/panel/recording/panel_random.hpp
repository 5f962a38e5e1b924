// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace dfdyn::tests {

/// Random numbers that are equal with every standard library.
class Draw {
  public:
    /// Different values of `stream` with one seed give independent numbers.
    Draw(std::uint64_t seed, std::uint32_t stream) {
        std::seed_seq sequence{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32U),
                               stream};
        engine_.seed(sequence);
    }

    double uniform(double from, double to) {
        constexpr double step = 0x1p-53;
        return from + (to - from) * static_cast<double>(engine_() >> 11U) * step;
    }
    /// Uniform in the logarithm; both bounds are positive.
    double log_uniform(double from, double to) { return from * std::exp(uniform(0, std::log(to / from))); }
    bool chance(double share) { return uniform(0, 1) < share; }
    double sign() { return chance(0.5) ? 1 : -1; }
    std::size_t below(std::size_t count) { return static_cast<std::size_t>(engine_() % count); }
    int whole(int from, int to) {
        return from + static_cast<int>(below(static_cast<std::size_t>(to - from) + 1));
    }

    template <class T>
    const T& of(const std::vector<T>& choices) {
        return choices[below(choices.size())];
    }

    std::uint64_t seed() { return engine_(); }

  private:
    std::mt19937_64 engine_;
};

} // namespace dfdyn::tests
