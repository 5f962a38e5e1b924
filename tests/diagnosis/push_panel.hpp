// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/diagnosis/panel_setup.hpp"
#include "tests/diagnosis/panel_table.hpp"

#include <functional>

namespace dfdyn::tests {

/// Somebody pushes at a joint that stands.
struct HiddenPush {
    Eigen::Index joint = 0;
    double start_s = 0, end_s = 0;
    double peak = 0; ///< N·m
    double held = 0; ///< N·m by which the joint's static friction can change
};

/// An arm that goes from posture to posture and waits there, with friction at all joints.
struct PushCase {
    PanelSetup setup;
    std::vector<HiddenPush> pushes; ///< none in a third of the cases
    tools::Recording recording;
};

/// The case of `seed`; the same seed gives the same bytes. Cost: a simulation of 80 s.
PushCase make_push_case(std::uint64_t seed);

/// What the diagnosis said of pushes.
struct PushScore {
    std::uint64_t seed = 0;
    std::string robot;
    bool constants_known = true; ///< otherwise peaks are in the unit of an estimated one
    std::vector<HiddenPush> pushes;
    std::vector<double> found; ///< per push: the largest confidence of a contact at its joint and time, or 0
    struct Named : Judged {    ///< right: at the joint and time of a push
        bool in_interval = false; ///< and its peak in the interval
        double peak_over_true = 0;
    };
    std::vector<Named> named;
};

/// Of the seeds from `seed` on, one case each. `done` is told of each.
std::vector<PushScore> run_push_panel(std::uint64_t seed, int cases,
                                      const std::function<void(const PushScore&)>& done);

/// A line on one case.
std::string describe(const PushScore& score);

/// Found by the push's size; how often contacts of each confidence were right; recordings without a push
/// that have one. Markdown.
std::string push_tables(const std::vector<PushScore>& scores);

} // namespace dfdyn::tests
