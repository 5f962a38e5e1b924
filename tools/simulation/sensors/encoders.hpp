// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/robot/dynamics/joint_vector.hpp"
#include "tools/simulation/faults/fault.hpp"

#include <optional>
#include <vector>

namespace dfdyn::tools {

/// Errors of the encoder readings relative to the joint positions.
struct EncoderModel {
    double rate_hz = 1000;
    int bits_per_turn = 0;             ///< 0: no quantization; a prismatic joint has 2^bits counts per metre
    double noise = 0;                  ///< rad, standard deviation, before quantization
    JointVector eccentricity;          ///< rad, amplitude of one cycle per turn
    JointVector eccentricity_phase;    ///< rad
    std::optional<JointVector> offset; ///< rad: reading minus position
};

/// Encoder readings, held until the next one. Each reading applies offset, eccentricity (amplitude · sin(q +
/// phase)), noise, rounding to the nearest count, and faults.
class Encoders {
  public:
    Encoders(EncoderModel model, std::vector<bool> prismatic, std::uint64_t seed);

    void observe(const JointVector& position);
    /// Sets the faults for the next and later readings.
    void set_faults(const EncoderFaults& faults) { faults_ = faults; }
    const JointVector& reading() const noexcept { return reading_; }

    /// Size of one count of joint `joint`, rad or m; 0 without quantization.
    double count(std::size_t joint) const;

  private:
    /// `last`: the previous reading; empty at the first one.
    void add_faults(const JointVector& last);

    EncoderModel model_;
    std::vector<bool> prismatic_;
    NormalSource noise_;
    JointVector reading_;
    std::optional<EncoderFaults> faults_;
};

} // namespace dfdyn::tools
