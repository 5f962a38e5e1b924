// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/recordings/several_recordings.hpp"
#include "tools/diagnosis/verdict/error_reduction.hpp"

#include <vector>

namespace dfdyn::tools {

/// Names the loads of single recordings. With `fitted_everywhere` (the pooled fit explains every joint) also
/// wrong links and the load of all recordings, and doubts those that only the joined recording supports.
/// `ends_s`: times of the last row of each recording in the joined one.
void name_bodies(DiagnosisWork& work, const SeveralRecordings& several, const std::vector<double>& ends_s,
                 const ErrorReduction& reduction, bool fitted_everywhere);

} // namespace dfdyn::tools
