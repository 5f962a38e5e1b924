// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/timing/interleaved.hpp"

#include <memory>
#include <string>

namespace dfdyn::tools {

/// What no sweep over a factor of p columns can be faster than on this machine, µs.
struct Floor {
    double arithmetic = 0; ///< 1.5 p² multiply-adds, as many at a time as the processor takes
    double memory = 0;     ///< one read and one write of the packed triangle, as it was measured
    double total() const noexcept { return arithmetic > memory ? arithmetic : memory; }
};

/// 1.5 p² multiply-adds in µs; `vectors_per_ns` as the probe gives it.
double arithmetic_floor_us(int columns, const std::string& scalar, double vectors_per_ns);

/// One read and one write of p(p+1)/2 numbers, in place, by whole vectors.
std::unique_ptr<Ticking> make_triangle_pass(int columns, const std::string& scalar);

} // namespace dfdyn::tools
