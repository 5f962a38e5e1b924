// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel/recording/panel_setup.hpp"
#include "tests/diagnosis/panel/score/panel_table.hpp"

#include <functional>

namespace dfdyn::tests {

/// A push at a joint at rest.
struct HiddenPush {
    Eigen::Index joint = 0;
    double start_s = 0, end_s = 0;
    double peak = 0; ///< N·m
    double held = 0; ///< N·m: largest change of the joint's static friction
};

/// An arm with friction at all joints that moves between postures and waits at each.
struct PushCase {
    PanelSetup setup;
    std::vector<HiddenPush> pushes; ///< empty in a third of the cases
    tools::Recording recording;
};

/// Makes the case of `seed`; equal seeds give equal bytes. Cost: a simulation of 80 s.
PushCase make_push_case(std::uint64_t seed);

/// Contacts that the diagnosis reports, compared with the pushes.
struct PushScore {
    std::uint64_t seed = 0;
    std::string robot;
    bool constants_known = true; ///< otherwise peaks have the unit of an estimated constant
    std::vector<HiddenPush> pushes;
    std::vector<double> found; ///< per push: the largest confidence of a contact at its joint and time, or 0
    struct Named : Judged {    ///< right if at the joint and time of a push
        bool in_interval = false; ///< whether the peak is in the interval
        double peak_over_true = 0;
    };
    std::vector<Named> named;
};

/// Scores one case for each of `cases` seeds from `seed` on. Calls `done` with each score.
std::vector<PushScore> run_push_panel(std::uint64_t seed, int cases,
                                      const std::function<void(const PushScore&)>& done);

/// Describes a case in one line.
std::string describe(const PushScore& score);

/// Markdown tables: detections by the size of the push, shares of right contacts by confidence, and
/// recordings without a push but with a contact.
std::string push_tables(const std::vector<PushScore>& scores);

} // namespace dfdyn::tests
