// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/assembly/joint_count.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace dfdyn::hal {

/// Event at which a sample may be assembled.
struct SampleTrigger {
    enum class Kind : std::uint8_t {
        none,
        sync, ///< a SYNC: the values measured at the SYNC before it are complete
        set   ///< every joint and the output have new measurements since the last set
    };
    Kind kind = Kind::none;
    std::int64_t instant_ns = 0;
};

/// Detects the sample times of an arm of n joints: SYNCs, and complete sets. O(n) per frame.
template <int n>
class SampleTriggerWatch {
  public:
    explicit constexpr SampleTriggerWatch(Extent<n> joints) noexcept : joints_(joints) {}

    /// Takes the stamp of a SYNC. Each drive reports the same one; only the first report counts.
    constexpr SampleTrigger synchronised(std::int64_t stamp_ns) noexcept {
        const bool again = synchronised_ && stamp_ns == sync_ns_;
        if (again) {
            return {};
        }
        const bool first = !synchronised_;
        const std::int64_t before_ns = sync_ns_;
        synchronised_ = true;
        sync_ns_ = stamp_ns;
        const bool ran_back = stamp_ns < before_ns; // the time of the one before is unknown
        return first || ran_back ? SampleTrigger{} : SampleTrigger{SampleTrigger::Kind::sync, before_ns};
    }

    /// Notes a new position of a joint.
    constexpr void measured(std::size_t joint) noexcept { seen_[joint] = true; }

    /// Drops a set that is not complete at `now_ns`, for a caller that does not wait for lost frames: its
    /// joints, and any output measured until then. The loss of half an output is detected only when the next
    /// output arrives; that half does not complete a set. Returns true if the dropped set contained a joint.
    constexpr bool drop_set(std::int64_t now_ns) noexcept {
        const bool any = std::any_of(seen_.begin(), seen_.begin() + joints_, [](bool seen) { return seen; });
        seen_ = {};
        set_ns_ = std::max(set_ns_, now_ns);
        return any;
    }

    /// Returns a trigger if all joints and the output, measured at `output_ns`, are new.
    constexpr SampleTrigger completed(std::int64_t output_ns) noexcept {
        const bool joints =
            std::all_of(seen_.begin(), seen_.begin() + joints_, [](bool seen) { return seen; });
        if (!joints || output_ns <= set_ns_) {
            return {};
        }
        seen_ = {};
        set_ns_ = output_ns;
        return {SampleTrigger::Kind::set, set_ns_};
    }

  private:
    [[no_unique_address]] Extent<n> joints_;
    PerJoint<bool, n> seen_{};
    bool synchronised_ = false;
    std::int64_t sync_ns_ = 0;
    std::int64_t set_ns_ = std::numeric_limits<std::int64_t>::min(); ///< sample time of the last set
};

} // namespace dfdyn::hal
