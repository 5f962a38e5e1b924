// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/diagnosis/extension/extension.hpp"

#include <Eigen/Core>

#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// One-step prediction error of an online learner, relative to the measured output's standard deviation. NaN
/// if there is none.
struct OnlineError {
    std::string learner;
    Eigen::VectorXd transient, steady; ///< per output: over the first third of the ticks, and over the rest
};

/// One-step errors of learners that run over the recordings tick by tick, from positions alone.
struct OnlineView {
    std::vector<OnlineError> learners;
    std::string left_out; ///< why learners with random features were not run; empty if they were run
};

/// Runs parametric learners that start from the robot's own parameters:
///
/// - the rigid body alone;
/// - the rigid body with the named effects, which start at zero;
/// - `written`, the extended model, which was fitted to the recordings.
///
/// On recordings of up to 40,000 rows it also runs NP and SPK with 100 random features, without and with the
/// named effects. Their hyperparameters are fitted to the recordings; their weights start at zero.
OnlineView online_view(const DiagnosisWork& work, const ModelExtension& extension,
                       const TrainedModel& written, std::span<const Recording> recordings);

} // namespace dfdyn::tools
