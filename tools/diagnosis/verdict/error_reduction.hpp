// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

namespace dfdyn::tools {

/// Computes the error reduction of findings, as figures and as text. `signals` and `output_names` must
/// outlive it.
class ErrorReduction {
  public:
    /// `rest`: T x m, the residual after all causes.
    ErrorReduction(const DiagnosisSignals& signals, const Eigen::MatrixXd& rest,
                   const std::vector<std::string>& output_names);

    /// Sets the output, the errors with and without the effect, the series and the evidence of a finding that
    /// adds `contribution` (T x m). The errors are those below `reduction_below_hz`, or at all frequencies if
    /// the effect acts only above that.
    void describe(Finding& finding, const Eigen::MatrixXd& contribution) const;

  private:
    std::string evidence_text(const Finding& finding, const std::string& band) const;

    const DiagnosisSignals& signals_;
    const std::vector<std::string>& output_names_;
    /// Arms have little motion above `reduction_below_hz`. Unexplained errors at high frequencies could mask
    /// a cause that explains the low ones.
    Eigen::MatrixXd rest_, slow_rest_;
};

/// Returns whether the error of the finding's output is smaller with the effect than without it.
bool reduces_error(const Finding& finding);

} // namespace dfdyn::tools
