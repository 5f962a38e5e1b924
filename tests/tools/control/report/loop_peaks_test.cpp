// SPDX-License-Identifier: Apache-2.0
#include "tools/control/report/loop_peaks.hpp"

#include "tests/support/catch.hpp"

#include <sstream>

namespace loop_peaks_test {

using namespace dfdyn::tools;

TEST_CASE("peaks are the largest step between two commands and the largest speed of each joint") {
    LoopPeaks peaks;
    std::ostringstream text;
    print_peaks(text, peaks);
    const auto add = [&](double torque1, double torque2, double velocity1, double velocity2) {
        peaks.add(JointVector(Eigen::Vector2d(torque1, torque2)),
                  JointVector(Eigen::Vector2d(velocity1, velocity2)));
    };
    add(50, 1, -3, 0.1);
    print_peaks(text, peaks);
    CHECK(text.str().empty());
    add(40, 2, 1, 0.2);
    add(52, -1, 2, -0.3);
    add(52, -1, 0, 0);
    CHECK(peaks.torque_step() == JointVector(Eigen::Vector2d(12, 3)));
    CHECK(peaks.speed() == JointVector(Eigen::Vector2d(3, 0.3)));
    print_peaks(text, peaks);
    CHECK(text.str() == "peaks: command, from tick to tick, by 12.0, 3.0 N·m; joints at 3.00, 0.30 rad/s\n");
}

TEST_CASE("without speeds only the peaks of the commands are printed") {
    LoopPeaks peaks;
    peaks.add(JointVector::Constant(1, 2));
    peaks.add(JointVector::Constant(1, -3));
    std::ostringstream text;
    print_peaks(text, peaks);
    CHECK(text.str() == "peaks: command, from tick to tick, by 5.0 N·m\n");
}

} // namespace loop_peaks_test
