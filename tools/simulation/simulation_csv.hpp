// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/csv_writer.hpp"
#include "tools/simulation/simulation.hpp"

#include <ostream>

namespace dfdyn::tools {

/// Writes the sensors' readings: `t` and the scenario's columns, in the order t, q, qd, qdd, tau, i, wrench.
class SimulatedRecordingCsv {
  public:
    SimulatedRecordingCsv(std::ostream& out, const Scenario& scenario, std::size_t joint_count);
    void write(const SimulatedSample& sample);

  private:
    bool has(const char* column) const;

    Scenario scenario_;
    CsvWriter csv_;
};

/// Writes the true quantities: t, q, qd, qdd, tau, friction1.., wrench if the robot has a sensor, tip_x tip_y
/// tip_z.
class SimulatedTruthCsv {
  public:
    SimulatedTruthCsv(std::ostream& out, bool with_wrench, std::size_t joint_count);
    void write(const SimulatedTruth& truth);

  private:
    bool with_wrench_;
    CsvWriter csv_;
};

} // namespace dfdyn::tools
