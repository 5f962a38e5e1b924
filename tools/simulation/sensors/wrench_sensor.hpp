// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/simulation/sensors/low_pass.hpp"

#include <vector>

namespace dfdyn::tools {

/// What stands between the wrench and the reading. Six numbers: force in N, then torque in N·m.
struct WrenchSensorModel {
    double rate_hz = 1000;
    Wrench range = Wrench::Zero(); ///< full scale to both sides; beyond it the reading saturates
    int bits = 16;                 ///< of the whole range, both signs
    Eigen::Vector3d rotation = Eigen::Vector3d::Zero();  ///< rad: roll, pitch, yaw that turn the true wrench
    WrenchMatrix calibration = WrenchMatrix::Identity(); ///< times the true wrench: gains and crosstalk
    Wrench noise = Wrench::Zero();                       ///< standard deviation of a reading
    double bandwidth_hz = 0;                             ///< -3 dB; 0: no filter
    int order = 2;                                       ///< of the filter
    Wrench bias = Wrench::Zero();                        ///< at t = 0
    Wrench drift_per_s = Wrench::Zero();                 ///< of the bias
    double delay_s = 0;                                  ///< on top of the filter's
};

/// The chain of a six-axis sensor: low pass, delay (fractions of a step by linear interpolation), wrong
/// mounting, error of calibration, bias and drift, noise, saturation, quantiser (to the nearest of 2^bits
/// steps of the range), hold until the next reading.
class WrenchSensor {
  public:
    /// `period_s`: of the simulation's steps, of which the sensor's period must be a multiple.
    WrenchSensor(const WrenchSensorModel& model, double period_s, std::uint64_t seed);

    /// One step of the simulation, at `time_s`.
    void observe(double time_s, const Wrench& wrench);

    /// The last reading.
    const Wrench& reading() const noexcept { return reading_; }

    /// The size of one step of the quantiser.
    Wrench step() const;

  private:
    Wrench delayed(const Wrench& wrench);

    WrenchSensorModel model_;
    WrenchMatrix response_; ///< calibration after mounting
    std::int64_t steps_per_reading_;
    std::int64_t next_ = 0; ///< steps until the next reading
    LowPass filter_;
    double delay_steps_;
    std::vector<Wrench> past_; ///< ring of the filter's outputs
    std::size_t newest_ = 0;
    NormalSource noise_;
    Wrench reading_ = Wrench::Zero();
};

} // namespace dfdyn::tools
