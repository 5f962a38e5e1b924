// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/hal/campaign/faults.hpp"

#include <vector>

namespace dfdyn::tests {

/// What the frames of one joint show of its position, compared with the truth. The judge takes from here for
/// how long no right reading came: that is all that a receiver can know about a position which the joint's
/// limits allow.
///
/// The readings form runs. A run begins after a silence, or where the error of what the device shows jumps.
/// Where the error is that of an earlier run of many readings, that run goes on. After a silence or a jump,
/// right readings end the time without a right reading only after as long again, at most 0.42 s.
class JointSight {
  public:
    struct Run {
        std::int64_t begin_ns = 0; ///< true time
        std::int64_t blind_ns = 0; ///< from the last right reading to the begin, by whichever clock is longer
        double error_rad = 0;      ///< of what the device shows at the begin
        double from_zero_rad = 0;  ///< of what it shows there
        double velocity = 0;       ///< of the joint there
        int readings = 0;
    };

    JointSight(const FaultSite& site, std::size_t joint);

    /// The run that an instant belongs to.
    [[nodiscard]] const Run& run_at(std::int64_t true_ns) const;

    /// How long before the wrong readings around an instant the last right one came, at most; 0: all that an
    /// interpolation may use are right.
    [[nodiscard]] std::int64_t blind_at(std::int64_t time_ns) const;

  private:
    struct Reading {
        std::int64_t true_ns, stamp_ns; ///< when it came, and its stamp
        std::int64_t time_ns;           ///< its stamp by the true clock
        double error_rad;
        bool right;
    };
    /// A reading with the time since the last right one; 0: it is right.
    struct Blind {
        std::int64_t time_ns, blind_ns;
    };

    void take(Run seen, const Reading& reading);
    void begin_run(Run seen, const Reading& reading);

    std::vector<Run> runs_{Run{}};
    std::vector<Blind> blind_; ///< by time
    Reading last_{}, last_established_{};
    Run wrong_{}; ///< the last wrong run of many readings
    double wrong_rad_ = 0;
};

} // namespace dfdyn::tests
