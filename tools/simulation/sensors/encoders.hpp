// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/robot/dynamics/joint_vector.hpp"
#include "tools/simulation/faults/fault.hpp"

#include <optional>
#include <vector>

namespace dfdyn::tools {

/// What stands between the joint positions and their readings.
struct EncoderModel {
    double rate_hz = 1000;
    int bits_per_turn = 0;             ///< 0: no quantiser; a prismatic joint has 2^bits counts per metre
    double noise = 0;                  ///< rad, standard deviation, before the quantiser
    JointVector eccentricity;          ///< rad, amplitude of one cycle per turn
    JointVector eccentricity_phase;    ///< rad
    std::optional<JointVector> offset; ///< rad: reading minus position
};

/// Readings, held until the next: offset, eccentricity (amplitude · sin(q + phase)), noise, rounding to the
/// nearest count, faults.
class Encoders {
  public:
    Encoders(EncoderModel model, std::vector<bool> prismatic, std::uint64_t seed);

    void observe(const JointVector& position);
    /// From the next reading on.
    void set_faults(const EncoderFaults& faults) { faults_ = faults; }
    const JointVector& reading() const noexcept { return reading_; }

    /// The size of one count of joint `joint`, rad or m; 0 without quantiser.
    double count(std::size_t joint) const;

  private:
    /// `last`: the reading before; empty at the first.
    void add_faults(const JointVector& last);

    EncoderModel model_;
    std::vector<bool> prismatic_;
    NormalSource noise_;
    JointVector reading_;
    std::optional<EncoderFaults> faults_;
};

} // namespace dfdyn::tools
