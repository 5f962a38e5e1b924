// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/diagnosis.hpp"
#include "tools/diagnosis/recordings/arm_question.hpp"

#include <string>
#include <vector>

namespace dfdyn::tools {

/// Several recordings of one arm, and what they say together.
struct SeveralRecordings {
    std::vector<std::string> names;  ///< of all recordings: of the file, or its path where names are equal
    std::vector<std::size_t> pooled; ///< of them, those that are in the fit: number of each
    ArmAnswer answer;                ///< its recordings are those of `pooled`
    Eigen::VectorXd torque_gains;    ///< per output: measured unit per N·m (N)
    double seconds = 0;              ///< duration of all pooled recordings

    /// Returns whether there is an answer: at least two recordings could be read as motion.
    bool answered() const { return pooled.size() > 1; }
};

/// Fits several recordings at once, each with its own clock, filters and noise. Not answered for fewer than
/// two recordings and for wrenches. Recordings without a segment that is long enough are left out. Cost: that
/// of `information_of` per recording and of `ask_recordings`.
SeveralRecordings fit_recordings(const Robot& robot, const std::vector<Recording>& recordings,
                                 const DiagnosisOptions& options, bool loads_differ);

/// Subtracts from the outputs of each recording what a load adds that it alone has, so that the rest is the
/// same arm in all.
void take_loads_off(std::vector<Recording>& recordings, const Robot& robot, const SeveralRecordings& several,
                    OutputKind outputs);

} // namespace dfdyn::tools
