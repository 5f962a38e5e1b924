// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/extension/joined_recording.hpp"

#include "tests/support/catch.hpp"

#include <array>

namespace {

using namespace dfdyn::tools;

/// A recording of 3 rows, 10 ms apart.
Recording recording(const char* source, double first_s, double value) {
    Recording result;
    result.source = source;
    result.position = {{"q1"}, {value, value + 1, value + 2}};
    result.output = {{"tau1"}, {value, value, value}};
    for (int row = 0; row < 3; ++row) {
        result.time_s.push_back(first_s + 0.01 * row);
        result.time_ns.push_back(static_cast<std::int64_t>(1e9 * result.time_s.back() + 0.5));
    }
    result.gap_before = {1, 0, 0};
    return result;
}

} // namespace

TEST_CASE("joined recordings have increasing times and a gap where each one begins") {
    const std::array<Recording, 2> parts{recording("a.csv", 5, 1), recording("b.csv", 0, 7)};
    const Recording joined = joined_recording(parts);
    REQUIRE(joined.row_count() == 6);
    CHECK(joined.time_s[2] == Approx(5.02));
    CHECK(joined.time_s[3] == Approx(7.02));
    CHECK(joined.time_s[5] == Approx(7.04));
    CHECK(joined.gap_before == std::vector<std::uint8_t>{1, 0, 0, 1, 0, 0});
    CHECK(joined.position.values == std::vector<double>{1, 2, 3, 7, 8, 9});
    CHECK(joined.output.values == std::vector<double>{1, 1, 1, 7, 7, 7});
    CHECK(joined.source == "a.csv, b.csv");
    CHECK(joined_recording(std::span(parts).first(1)).time_ns == parts[0].time_ns);
}
