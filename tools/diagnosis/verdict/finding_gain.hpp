// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Computes the error reduction of findings, as figures and as text. `signals` and `output_names` must
/// outlive it.
class Gains {
  public:
    /// `rest`: T x m, the residual after all causes.
    Gains(const DiagnosisSignals& signals, const Eigen::MatrixXd& rest,
          const std::vector<std::string>& output_names);

    /// Measures the gain of a finding that adds `contribution` (T x m): below `gains_below_hz`, or at all
    /// frequencies if the effect acts only above that. Returns whether the error decreases.
    bool tell(Finding& finding, const Eigen::MatrixXd& contribution) const;

  private:
    const DiagnosisSignals& signals_;
    const std::vector<std::string>& output_names_;
    /// Arms have little motion above `gains_below_hz`. Unexplained errors at high frequencies could mask a
    /// cause that explains the low ones.
    Eigen::MatrixXd rest_, slow_rest_;
};

} // namespace dfdyn::tools
