// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"

#include <vector>

namespace dfdyn::tools {

/// Lowers the confidence of causes that recordings contradict. In each recording the cause's contribution is
/// fitted to the residual, with its size as a factor of the size found. If the mean of these factors, with
/// their spread between recordings (R. DerSimonian and N. Laird, 1986), is less than two standard deviations
/// above zero, the confidence is below 0.5, and `evidence` lists the factors. Contacts and loads of one
/// recording are exempt. `ends_s`: time of the last row of each recording in the diagnosed one. Cost: O(T)
/// per finding and lag of the residual's correlation.
void doubt_contradicted_findings(DiagnosisWork& work, const std::vector<double>& ends_s);

} // namespace dfdyn::tools
