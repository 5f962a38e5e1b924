// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tools/diagnosis/extension/joined_recording.hpp"

#include <vector>

namespace ends_in_joined_test {

using namespace dfdyn::tools;

/// A recording of these rows, 10 ms apart.
Recording recording(int rows, double first_s) {
    Recording result;
    result.position.names = {"q1"};
    result.output.names = {"tau1"};
    for (int row = 0; row < rows; ++row) {
        result.time_ns.push_back(static_cast<std::int64_t>(1e9 * first_s) + 10'000'000LL * row);
        result.time_s.push_back(1e-9 * static_cast<double>(result.time_ns.back()));
        result.position.values.push_back(row);
        result.output.values.push_back(row);
        result.gap_before.push_back(row == 0 ? 1 : 0);
    }
    return result;
}

/// Checks the ends against the times of the joined recording.
void check_ends(const std::vector<Recording>& recordings) {
    const Recording joined = joined_recording(recordings);
    const std::vector<double> ends_s = ends_in_joined(recordings);
    REQUIRE(ends_s.size() == recordings.size());
    std::size_t rows = 0;
    for (std::size_t r = 0; r < recordings.size(); ++r) {
        CAPTURE(r);
        rows += recordings[r].row_count();
        if (rows > 0) {
            CHECK(ends_s[r] == Approx(joined.time_s.at(rows - 1)).margin(1e-9));
        }
    }
    CHECK(rows == joined.row_count());
}

TEST_CASE("the end of each recording is the time of its last row in the joined one") {
    check_ends({recording(3, 0)});
    check_ends({recording(3, 5), recording(40, 0), recording(7, 1000)});
}

TEST_CASE("a recording of one row ends where it begins, and an empty one where the previous one ends") {
    check_ends({recording(3, 5), recording(1, 70), recording(7, 1)});
    check_ends({recording(1, 5), recording(1, 5), recording(1, -3)});
    check_ends({recording(3, 5), recording(0, 0), recording(7, 1)});
    check_ends({recording(0, 0), recording(3, 5), recording(7, 1)});
}

} // namespace ends_in_joined_test
