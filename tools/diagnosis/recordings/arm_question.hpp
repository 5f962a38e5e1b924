// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/diagnosis/recordings/pooled_fit.hpp"
#include "tools/diagnosis/recordings/recording_information.hpp"

#include <array>
#include <optional>
#include <vector>

namespace dfdyn::tools {

/// What may differ between recordings beyond the usual spread.
struct Changed {
    bool payload = false;
    std::array<bool, terms_of_joint> terms{}; ///< by `TextbookTerm`
};

/// A difference of the arm from the robot's file that evidence supports.
struct ArmHypothesis {
    std::optional<Eigen::Index> body;     ///< a body whose parameters are wrong (0: the first), or
    std::optional<std::size_t> recording; ///< the recording that has a load
    double margin = 0;                    ///< log-evidence
    std::vector<Eigen::Index> others;     ///< bodies whose error the recordings hardly tell from it
};

/// A load at the tip in one recording.
struct RecordingLoad {
    std::size_t recording = 0;
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
/// `fit_arm`; one body may differ four times as much, and a recording may have a load at the tip where
/// `changed` has it, if the log-evidence is at least 8, which is the price of a cause in the panel's search.
/// Hypotheses are accepted one after the other, best first. `gains_known`: torque constants are given. Cost:
/// O(p³) per recording, hypothesis and iteration.
ArmAnswer ask_recordings(const DiagnosisSignals& signals, const std::vector<RecordingInformation>& recordings,
                         const Changed& changed, bool gains_known);

} // namespace dfdyn::tools
