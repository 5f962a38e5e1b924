// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dfdyn::tools {

/// Accumulates the errors of one output's forecasts.
class OutputError {
  public:
    /// Adds a pair; pairs with a value that is not finite are ignored.
    void add(double measured, double forecast);
    /// Returns rms(measured - forecast) / std(measured) of all pairs: NaN without pairs, infinite if the
    /// measured values are all equal.
    double normalised() const;

  private:
    double count_ = 0;
    double mean_ = 0;         ///< of the measured values
    double variation_ = 0;    ///< sum of their squared differences from the mean
    double error_square_ = 0; ///< sum
};

} // namespace dfdyn::tools
