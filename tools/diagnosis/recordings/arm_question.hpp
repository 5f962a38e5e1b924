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
    std::optional<Eigen::Index> body;     ///< the wrong body (0: the first); nothing: a load
    std::optional<std::size_t> recording; ///< the recording that alone has the load; nothing: all have it
    double margin = 0;                    ///< log-evidence
    std::vector<Eigen::Index> others;     ///< bodies whose error the recordings hardly tell from it
};

/// A load at the tip.
struct RecordingLoad {
    std::optional<std::size_t> recording;     ///< the one that has it; nothing: all
    double margin = 0;                        ///< log-evidence
    Eigen::Matrix<double, 10, 1> parameters;  ///< inertial parameters in the tip's frame
    Eigen::Matrix<double, 10, 10> covariance; ///< of them
    Eigen::Matrix<double, 10, 1> of_body;     ///< the same in the frame of the last body
};

/// The answer of several recordings to one question: what of the arm differs from its file.
struct ArmAnswer {
    PooledFit fit;
    std::vector<ArmHypothesis> wrong_links;
    std::vector<RecordingLoad> loads;
};

/// Pools recordings of one arm. `signals`: those of any of them. Links may differ from the file as in
/// `fit_arm`; a body may differ four times as much, and all recordings, or with `loads_differ` single ones,
/// may have a load at the tip, if the log-evidence is at least 8, which is the price of a cause in the
/// panel's search. Hypotheses are accepted one after the other, best first, and dropped if the later ones
/// explain them. A load has a positive mass, within reach of the tip. `gains_known`: torque constants are
/// given, and hold where the recordings do not contradict them. Cost: O(p³) per recording, hypothesis and
/// iteration.
ArmAnswer ask_recordings(const DiagnosisSignals& signals, const std::vector<RecordingInformation>& recordings,
                         bool loads_differ, bool gains_known);

} // namespace dfdyn::tools
