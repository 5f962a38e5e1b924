// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/simulation/sensors/delay_line.hpp"
#include "tools/simulation/sensors/low_pass.hpp"

namespace dfdyn::tools {

/// Errors of the F/T sensor. Six numbers: force in N, then torque in N·m.
struct WrenchSensorModel {
    double rate_hz = 1000;
    Wrench range = Wrench::Zero(); ///< full scale in both directions; readings saturate there
    int bits = 16;                 ///< for the whole range, both signs
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero(); ///< rad: roll, pitch, yaw that turn the true wrench
    /// multiplies the true wrench: gains and crosstalk
    WrenchMatrix calibration = WrenchMatrix::Identity();
    Wrench noise = Wrench::Zero();       ///< standard deviation of a reading
    double bandwidth_hz = 0;             ///< -3 dB; 0: no filter
    int order = 2;                       ///< of the filter
    Wrench bias = Wrench::Zero();        ///< at t = 0
    Wrench drift_per_s = Wrench::Zero(); ///< of the bias
    double delay_s = 0;                  ///< in addition to the filter's delay
};

/// Model of a six-axis sensor, in this order: low-pass filter, delay, wrong mounting, calibration error, bias
/// and drift, noise, saturation, quantization and hold until the next reading. Fractions of a step are
/// delayed by linear interpolation. Quantization rounds to the nearest of 2^bits steps of the range.
class WrenchSensor {
  public:
    /// `period_s`: step of the simulation; the sensor's period must be a multiple of it.
    WrenchSensor(const WrenchSensorModel& model, double period_s, std::uint64_t seed);

    /// Adds the wrench of one simulation step, at `time_s`.
    void observe(double time_s, const Wrench& wrench);

    /// Returns the last reading.
    const Wrench& reading() const noexcept { return reading_; }

    /// Returns the size of one quantization step.
    Wrench step() const;

  private:
    WrenchSensorModel model_;
    WrenchMatrix response_; ///< product of calibration and mounting rotation
    std::int64_t steps_per_reading_;
    std::int64_t next_ = 0; ///< steps until the next reading
    LowPass filter_;
    DelayLine<Wrench> delay_; ///< of the filter's outputs
    NormalSource noise_;
    Wrench reading_ = Wrench::Zero();
};

} // namespace dfdyn::tools
