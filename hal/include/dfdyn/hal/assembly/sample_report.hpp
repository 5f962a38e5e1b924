// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/track.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/reason.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

namespace dfdyn::hal {

/// Why a sample is as it is.
template <int n>
struct SampleReport {
    template <class T>
    using PerJoint = std::array<T, static_cast<std::size_t>(n)>;

    Reason position = Reason::ok; ///< ok: there is a sample
    int joint = unused_joint;     ///< the first joint that `position` is about, if it is about one
    Reason output = Reason::ok;   ///< ok: its output is valid
    /// Of each joint; those with ok have their position in the sample, whether or not all have.
    PerJoint<Reason> joint_reason{};
    /// How the positions, and the output, came about; none where there is none.
    PerJoint<ValueOrigin> position_origin{};
    ValueOrigin output_origin = ValueOrigin::none;
    /// Time since the newest position of each joint, and the newest output, were measured; the largest number
    /// where there is none.
    PerJoint<std::int64_t> position_age_ns{};
    std::int64_t output_age_ns = 0;
};

/// How often each reason occurred; never decreases.
struct AssemblyCounters {
    std::uint64_t calls = 0;
    std::uint64_t samples = 0;                                   ///< of them: with positions
    std::uint64_t outputs = 0;                                   ///< of them: with a valid output
    std::uint64_t bridged = 0;                                   ///< samples: with a value over a missing one
    std::array<std::uint64_t, reason_count> positions_refused{}; ///< by the reason's number
    std::array<std::uint64_t, reason_count> outputs_refused{};   ///< of calls with positions
};

} // namespace dfdyn::hal
