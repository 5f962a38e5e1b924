// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/recording/recording.hpp"
#include "tools/diagnosis/extension/extension.hpp"

#include <Eigen/Core>

#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// The one-step error of an online learner, of the measured output's deviation; NaN where there is none.
struct OnlineError {
    std::string learner;
    Eigen::VectorXd transient, steady; ///< per output: over the first third of the ticks, and over the rest
};

/// The diagnosis as learners see it that run over the recordings tick by tick, from positions alone.
struct OnlineView {
    std::vector<OnlineError> learners;
    std::string left_out; ///< why learners with random features were not run; empty where they were
};

/// Parametric learners, from the robot's own parameters: the rigid body alone; with the named effects, which
/// start at zero; and `written`, the extended model, which has seen the recordings. Then, on recordings of
/// up to 40,000 rows, NP and SPK without and with the names, of 100 random features: their hyperparameters
/// are of the recordings, what they learn starts from nothing.
OnlineView online_view(const DiagnosisWork& work, const Extension& extension, const TrainedModel& written,
                       std::span<const Recording> recordings);

} // namespace dfdyn::tools
