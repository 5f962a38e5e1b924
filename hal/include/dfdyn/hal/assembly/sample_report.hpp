// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/joint_count.hpp"
#include "dfdyn/hal/assembly/track.hpp"
#include "dfdyn/hal/device/decoded.hpp"
#include "dfdyn/hal/reason.hpp"
#include "dfdyn/sample.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dfdyn::hal {

/// Validity of a sample's values, and the numbers of joints and outputs in use (n and m).
template <int n, int m>
struct SampleReport {
    Reason position = Reason::ok; ///< ok: there is a sample
    int joint = unused_joint;     ///< first joint to which `position` applies, if any
    Reason output = Reason::ok;   ///< ok: its output is valid
    /// reasons of the joints; a joint with ok has its position in the sample, even if others have none
    PerJoint<Reason, n> joint_reason{};
    /// origins of the positions and of the output; none if there is no value
    PerJoint<ValueOrigin, n> position_origin{};
    ValueOrigin output_origin = ValueOrigin::none;
    /// time since the newest position of each joint, and the newest output, were measured; the largest
    /// integer if there is none
    PerJoint<std::int64_t, n> position_age_ns{};
    std::int64_t output_age_ns = 0;
    [[no_unique_address]] Extent<n> joints{};
    [[no_unique_address]] Extent<m> outputs{};
};

/// A sample and its report.
template <class Scalar, int n, int m>
struct AssembledSample {
    dfdyn::Sample<Scalar, places(n), places(m)> sample;
    SampleReport<n, m> report;

    /// Whether all positions are valid.
    [[nodiscard]] constexpr bool valid() const noexcept { return report.position == Reason::ok; }

    /// Positions of the arm's joints.
    [[nodiscard]] constexpr std::span<const Scalar> positions() const noexcept {
        return {sample.position.data(), static_cast<std::size_t>(report.joints)};
    }
    /// Outputs of the arm; empty if they are not valid.
    [[nodiscard]] constexpr std::span<const Scalar> valid_outputs() const noexcept {
        return {sample.output.data(), sample.output_valid ? static_cast<std::size_t>(report.outputs) : 0};
    }
    /// Reasons of the arm's joints.
    [[nodiscard]] constexpr std::span<const Reason> joint_reasons() const noexcept {
        return std::span(report.joint_reason).first(static_cast<std::size_t>(report.joints));
    }
};

/// Number of occurrences of each reason; never decreases.
struct AssemblyCounters {
    std::uint64_t calls = 0;
    std::uint64_t samples = 0; ///< calls with all positions
    std::uint64_t outputs = 0; ///< calls with a valid output
    std::uint64_t bridged = 0; ///< samples with a value interpolated over a missing one
    std::array<std::uint64_t, reason_count> positions_refused{}; ///< indexed by reason
    std::array<std::uint64_t, reason_count> outputs_refused{}; ///< of calls with positions, indexed by reason

    /// Counts the result of a call of `assemble`.
    template <class Scalar, int n, int m>
    constexpr void add(const AssembledSample<Scalar, n, m>& result) noexcept {
        const auto is_bridged = [](ValueOrigin origin) { return origin == ValueOrigin::bridged; };
        const bool any_bridged = is_bridged(result.report.output_origin) ||
                                 std::ranges::any_of(result.report.position_origin, is_bridged);
        ++calls;
        samples += result.valid() ? 1U : 0U;
        outputs += result.sample.output_valid ? 1U : 0U;
        bridged += result.valid() && any_bridged ? 1U : 0U;
        if (!result.valid()) {
            ++positions_refused[static_cast<std::size_t>(result.report.position)];
        } else if (!result.sample.output_valid) {
            ++outputs_refused[static_cast<std::size_t>(result.report.output)];
        }
    }
};

} // namespace dfdyn::hal
