// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/bench/timing/interleaved.hpp"

#include <memory>
#include <string>

namespace dfdyn::tools {

/// Lower bounds of the time (µs) of one sweep over a factor with p columns on this machine.
struct MachineLowerBound {
    double arithmetic = 0; ///< 1.5 p² multiply-adds at the processor's full vector width
    double memory = 0;     ///< one measured read and write of the packed triangle
    double total() const noexcept { return arithmetic > memory ? arithmetic : memory; }
};

/// Returns the time of 1.5 p² multiply-adds in µs; `vectors_per_ns` from the probe.
double arithmetic_floor_us(int columns, const std::string& scalar, double vectors_per_ns);

/// Returns a subject that reads and writes p(p+1)/2 numbers in place, by whole vectors.
std::unique_ptr<Ticking> make_triangle_pass(int columns, const std::string& scalar);

} // namespace dfdyn::tools
