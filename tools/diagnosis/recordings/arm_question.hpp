// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/recordings/pooled_fit.hpp"
#include "tools/diagnosis/recordings/recording_information.hpp"

#include <optional>
#include <vector>

namespace dfdyn::tools {

/// A difference of the arm from the robot's file that evidence supports: a body with wrong parameters, or a
/// load at the tip.
struct ArmHypothesis {
    std::optional<Eigen::Index> body;     ///< the wrong body (0: the first); empty: a load
    std::optional<std::size_t> recording; ///< the only recording with the load; empty: all have it
    double margin = 0;                    ///< log-evidence
    std::vector<Eigen::Index> others;     ///< bodies whose error is almost equally likely
};

/// A load at the tip.
struct RecordingLoad {
    std::optional<std::size_t> recording;     ///< the only one with the load; empty: all have it
    double margin = 0;                        ///< log-evidence
    Eigen::Matrix<double, 10, 1> parameters;  ///< inertial parameters in the tip's frame
    Eigen::Matrix<double, 10, 10> covariance; ///< of `parameters`
    Eigen::Matrix<double, 10, 1> of_body;     ///< the same in the frame of the last body
};

/// Differences of an arm from its file, estimated from several recordings.
struct ArmAnswer {
    PooledFit fit;
    std::vector<ArmHypothesis> wrong_links;
    std::vector<RecordingLoad> loads;
};

/// Fits all recordings of one arm together, and selects hypotheses: a body that differs four times as much
/// from the file as in `fit_arm`, or a load at the tip of all recordings or, with `loads_differ`, of one. A
/// hypothesis is accepted, best first, if its log-evidence is at least 8, as for a cause in the panel's
/// search. It is removed if later ones explain it. A load has a positive mass within 0.5 m of the tip.
/// `signals`: of any recording. `gains_known`: torque constants are given; they are used unless the
/// recordings contradict them. Cost: O(p³) per recording, hypothesis and iteration.
ArmAnswer ask_recordings(const DiagnosisSignals& signals, const std::vector<RecordingInformation>& recordings,
                         bool loads_differ, bool gains_known);

} // namespace dfdyn::tools
