// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// What findings bring, in figures and in words. `signals` and `output_names` must outlive it.
class Gains {
  public:
    /// `rest`: what no cause explains, T x m.
    Gains(const DiagnosisSignals& signals, const Eigen::MatrixXd& rest,
          const std::vector<std::string>& output_names);

    /// Of a finding that adds `contribution` (T x m): among errors below `gains_below_hz`, or where it shows
    /// above only, among all. Whether it brings anything.
    bool tell(Finding& finding, const Eigen::MatrixXd& contribution) const;

  private:
    const DiagnosisSignals& signals_;
    const std::vector<std::string>& output_names_;
    /// Above those that are slow arms hardly move, and what no cause explains there may hide that one
    /// explains what is below.
    Eigen::MatrixXd rest_, slow_rest_;
};

} // namespace dfdyn::tools
