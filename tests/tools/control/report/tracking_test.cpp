// SPDX-License-Identifier: Apache-2.0
#include "tools/control/report/tracking.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/control/report/tracking_report.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

namespace tracking_test {

using namespace dfdyn::tools;

JointVector two(double first, double second) {
    JointVector result(2);
    result << first, second;
    return result;
}

/// Errors of 3 and 4 mrad for one second, then of 6 and 8 mrad for one and a half seconds.
std::vector<TrackingWindow> windows() {
    Tracking tracking(1, 0.01);
    for (int tick = 0; tick < 250; ++tick) {
        const double scale = tick < 100 ? 1e-3 : 2e-3;
        const double sign = tick % 2 == 0 ? 1 : -1;
        tracking.add(0.01 * tick, two(3 * scale, 4 * scale * sign), two(0, tick < 100 ? 0.25 : 0.75));
    }
    return tracking.windows();
}

TEST_CASE("the tracking error is the root mean square of each complete window") {
    const std::vector<TrackingWindow> result = windows();
    REQUIRE(result.size() == 2);
    CHECK(result[0].start_s == 0);
    CHECK(result[1].end_s == 2);
    CHECK(result[0].rms[0] == Approx(3e-3));
    CHECK(result[0].rms[1] == Approx(4e-3));
    CHECK(result[0].all == Approx(5e-3 / std::sqrt(2)));
    CHECK(result[1].all == Approx(10e-3 / std::sqrt(2)));
    CHECK(result[0].learned[1] == Approx(0.25));
    CHECK(result[1].learned[1] == Approx(0.75));
}

TEST_CASE("the last window counts if its ticks are complete") {
    for (const auto& [ticks, complete] : {std::pair(199, 1U), std::pair(200, 2U), std::pair(201, 2U)}) {
        Tracking tracking(1, 0.01);
        for (int tick = 0; tick < ticks; ++tick) {
            tracking.add(0.01 * tick, two(1, 1), two(0, 0));
        }
        CHECK(tracking.windows().size() == complete);
    }
}

TEST_CASE("runs are printed side by side with the first run's error divided by the last run's") {
    std::vector<TrackingWindow> better = windows();
    for (TrackingWindow& window : better) {
        window.all /= 4;
    }
    std::ostringstream out;
    print_tracking(out, {{"nominal", windows()}, {"learned", better}});
    CHECK(out.str() == "tracking error, root mean square over all joints, mrad\n"
                       "  window (s)  nominal  learned    ratio\n"
                       "       0.000    3.536    0.884    4.000\n"
                       "       1.000    7.071    1.768    4.000\n");
}

TEST_CASE("a report has a table and curves and a page and needs a run with a complete window") {
    const dfdyn::tests::TemporaryDirectory directory;
    const std::filesystem::path folder = directory.path() / "out";
    {
        FileSet files;
        files.add_folder(folder);
        add_tracking(folder, "A title", {{"nominal", {}}}, files);
        files.commit();
    }
    CHECK(std::filesystem::is_empty(folder));
    FileSet files;
    add_tracking(folder, "A title", {{"nominal", windows()}, {"learned", windows()}}, files);
    files.commit();
    const std::string csv = dfdyn::tests::file_content(folder / "tracking.csv");
    CHECK_THAT(csv, Catch::Matchers::StartsWith("feed_forward,start,end,all,joint1,joint2,learned_share1,"
                                                "learned_share2\nnominal,0,1,"));
    CHECK(std::ranges::count(csv, '\n') == 5);
    CHECK_THAT(dfdyn::tests::file_content(folder / "tracking.svg"), Catch::Matchers::Contains("<svg"));
    CHECK_THAT(dfdyn::tests::file_content(folder / "tracking.html"), Catch::Matchers::Contains("A title"));
}

} // namespace tracking_test
