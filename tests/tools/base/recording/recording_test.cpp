// SPDX-License-Identifier: Apache-2.0
#include "tools/base/recording/recording.hpp"

#include "tests/support/catch.hpp"
#include "tools/base/text/error.hpp"

#include <string>
#include <vector>

using namespace dfdyn::tools;
using Names = std::vector<std::string>;

TEST_CASE("outputs are selected by kind") {
    CHECK(output_names(parse_output_kind("tau"), 2) == Names{"tau1", "tau2"});
    CHECK(output_names(parse_output_kind("i"), 3) == Names{"i1", "i2", "i3"});
    CHECK(output_names(parse_output_kind("wrench"), 2) == Names{"fx", "fy", "fz", "mx", "my", "mz"});
    CHECK_THROWS_MATCHES(parse_output_kind("Tau"), InputError,
                         Catch::Matchers::Message("--outputs: expected tau, i or wrench, found \"Tau\""));
}

TEST_CASE("a row range has an optional first and last row") {
    CHECK(parse_row_range(":").first == 0);
    CHECK_FALSE(parse_row_range(":").last);
    CHECK(parse_row_range("5:").first == 5);
    CHECK_FALSE(parse_row_range("5:").last);
    CHECK(parse_row_range(":7").first == 0);
    CHECK(parse_row_range(":7").last == 7);
    CHECK(parse_row_range("5:7").first == 5);
    CHECK(parse_row_range("5:7").last == 7);
    CHECK(parse_row_range("5:7").step == 1);
    CHECK(parse_row_range("5::2").first == 5);
    CHECK_FALSE(parse_row_range("5::2").last);
    CHECK(parse_row_range("5::2").step == 2);
}

TEST_CASE("an invalid row range is an error that quotes it") {
    const std::string whole_numbers = "FIRST:LAST, whole numbers from 0 or nothing";
    const std::string order = "FIRST before LAST (which is not included)";
    const auto [text, expected] = GENERATE_COPY(table<std::string, std::string>({
        {"", "FIRST:LAST"},
        {"5", "FIRST:LAST"},
        {"a:b", whole_numbers},
        {"-5:", whole_numbers},
        {"+5:", whole_numbers},
        {"1.5:", whole_numbers},
        {" 1:2", whole_numbers},
        {"1:2:x", whole_numbers},
        {"1:2:3:4", whole_numbers},
        {"1:2:0", "FIRST:LAST:STEP with a STEP from 1"},
        {"::", "FIRST:LAST:STEP with a STEP from 1"},
        {"99999999999999999999:", whole_numbers},
        {"7:7", order},
        {"7:5", order},
        {":0", order},
    }));
    CHECK_THROWS_MATCHES(
        parse_row_range(text), InputError,
        Catch::Matchers::Message("--rows: expected " + expected + ", found \"" + text + "\""));
}

TEST_CASE("skipped rows are described by reason") {
    CHECK(describe({}) == "0 rows skipped");
    CHECK(describe({.ragged = 1}) == "1 row skipped: 1 ragged");
    CHECK(describe({.ragged = 1, .not_a_number = 2, .out_of_range = 3, .time_not_increasing = 4}) ==
          "10 rows skipped: 1 ragged, 2 not a number, 3 out of range, 4 time not increasing");
}
