// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"
#include "tools/diagnosis/recordings/arm_question.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Several recordings of one arm, and their common fit.
struct SeveralRecordings {
    std::vector<std::string> names;  ///< names of all files, or their paths where names are equal
    std::vector<std::size_t> pooled; ///< indices of the recordings in the fit
    ArmAnswer answer;                ///< its recordings are those in `pooled`
    Eigen::VectorXd torque_gains;    ///< per output: measured unit per N·m (N)
    double seconds = 0;              ///< duration of all pooled recordings
    bool loads_differ = false;       ///< loads of single recordings were sought

    /// Returns whether there is a fit: at least two recordings can be used.
    bool fitted() const { return pooled.size() > 1; }
};

/// Fits several recordings at once, each with its own clock, filters and noise. There is no fit for fewer
/// than two recordings and for wrenches. Recordings without a segment that is long enough or with rows more
/// than 0.2 s apart are left out. Cost: `information_of` per recording, and `ask_recordings`.
SeveralRecordings fit_recordings(const Robot& robot, const std::vector<Recording>& recordings,
                                 const DiagnosisOptions& options, bool loads_differ);

/// Subtracts the torque of a recording's own load from its outputs, so that all recordings are of the same
/// arm.
void take_loads_off(std::vector<Recording>& recordings, const Robot& robot, const SeveralRecordings& several,
                    OutputKind outputs);

} // namespace dfdyn::tools
