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

/// Why a sample is as it is, and how many of its elements are used: of n joints and m outputs.
template <int n, int m>
struct SampleReport {
    Reason position = Reason::ok; ///< ok: there is a sample
    int joint = unused_joint;     ///< the first joint that `position` is about, if it is about one
    Reason output = Reason::ok;   ///< ok: its output is valid
    /// Of each joint; those with ok have their position in the sample, whether or not all have.
    PerJoint<Reason, n> joint_reason{};
    /// How the positions, and the output, came about; none where there is none.
    PerJoint<ValueOrigin, n> position_origin{};
    ValueOrigin output_origin = ValueOrigin::none;
    /// Time since the newest position of each joint, and the newest output, were measured; the largest number
    /// where there is none.
    PerJoint<std::int64_t, n> position_age_ns{};
    std::int64_t output_age_ns = 0;
    [[no_unique_address]] Extent<n> joints{};
    [[no_unique_address]] Extent<m> outputs{};
};

/// A sample, and why it is as it is.
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
    std::uint64_t samples = 0;                                   ///< of them: with positions
    std::uint64_t outputs = 0;                                   ///< of them: with a valid output
    std::uint64_t bridged = 0;                                   ///< samples: with a value over a missing one
    std::array<std::uint64_t, reason_count> positions_refused{}; ///< by the reason's number
    std::array<std::uint64_t, reason_count> outputs_refused{};   ///< of calls with positions

    /// Counts a call of `assemble` by what came of it.
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
