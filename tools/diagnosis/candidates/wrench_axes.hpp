// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/effects/effect.hpp"

#include <array>

namespace dfdyn::tools {

inline constexpr std::array<const char*, 6> wrench_axes{"fx", "fy", "fz", "mx", "my", "mz"};
inline constexpr std::array<const char*, 6> wrench_units{"N", "N", "N", "N·m", "N·m", "N·m"};

/// Returns a candidate that adds `series` (T) to the axes of the F/T sensor, one column each. Its shapes are
/// every axis alone, the forces, the torques, and all axes. `kinds`: the parameter of each axis.
Candidate on_each_axis(const Eigen::VectorXd& series, const std::array<ParameterKind, 6>& kinds);

/// Influence of one axis on another one, or on itself, in the model's output; `pair`: 6 from + to.
struct AxisPair {
    Eigen::Index from, to;

    explicit AxisPair(std::size_t pair)
        : from(static_cast<Eigen::Index>(pair / 6)), to(static_cast<Eigen::Index>(pair % 6)) {}
    bool own() const { return from == to; }
    Candidate candidate(const FittedModel& model) const;
};

} // namespace dfdyn::tools
