// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/base/text/error.hpp"

#include <cstdint>
#include <locale>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::TemporaryDirectory;
using Names = std::vector<std::string>;
using Values = std::vector<double>;
using Flags = std::vector<std::uint8_t>;

Recording read(std::string_view content, const ReadOptions& options = {}) {
    const TemporaryDirectory directory;
    return read_recording(directory.write("log.csv", content), options);
}

constexpr std::string_view two_joints = "t,q1,q2,qd1,qd2,qdd1,qdd2,tau1,tau2\n"
                                        "0,1,2,3,4,5,6,7,8\n"
                                        "0.008,-1,-2,-3,-4,-5,-6,-7,-8\n";

} // namespace

TEST_CASE("a recording contains the requested columns row by row") {
    const Recording recording =
        read(two_joints, {.outputs = OutputKind::joint_torque, .velocity = true, .acceleration = true});
    CHECK(recording.row_count() == 2);
    CHECK(recording.joint_count() == 2);
    CHECK(recording.time_s == Values{0, 0.008});
    CHECK(recording.time_ns == std::vector<std::int64_t>{0, 8'000'000});
    CHECK(recording.position.names == Names{"q1", "q2"});
    CHECK(recording.position.values == Values{1, 2, -1, -2});
    CHECK(recording.velocity.names == Names{"qd1", "qd2"});
    CHECK(recording.velocity.values == Values{3, 4, -3, -4});
    CHECK(recording.acceleration.names == Names{"qdd1", "qdd2"});
    CHECK(recording.acceleration.values == Values{5, 6, -5, -6});
    CHECK(recording.output.names == Names{"tau1", "tau2"});
    CHECK(recording.output.values == Values{7, 8, -7, -8});
    CHECK(recording.gap_before == Flags{1, 0});
    CHECK(recording.ignored_columns.empty());
    const std::span<const double> row = recording.output.row(1);
    CHECK(Values(row.begin(), row.end()) == Values{-7, -8});
    CHECK_THAT(recording.source, Catch::Matchers::EndsWith("/log.csv"));
}

TEST_CASE("columns that were not requested are ignored and listed whatever they contain") {
    const Recording recording = read("note,q1,t,,qd1,tau1,qdd1,\nhand, 1 ,0,x,nan,,-,\n");
    CHECK(recording.ignored_columns ==
          Names{"note", "column 4 (unnamed)", "qd1", "tau1", "qdd1", "column 8 (unnamed)"});
    CHECK(recording.position.values == Values{1});
    CHECK_FALSE(recording.velocity.present());
    CHECK_FALSE(recording.acceleration.present());
    CHECK_FALSE(recording.output.present());
}

TEST_CASE("velocities and accelerations that a recording lacks are reported as absent") {
    const Recording recording = read("t,q1\n0,1\n", {.velocity = true, .acceleration = true});
    CHECK_FALSE(recording.velocity.present());
    CHECK_FALSE(recording.acceleration.present());
}

TEST_CASE("columns are found by name and ordered by joint") {
    const Recording recording =
        read("mz,q2,fx,my,fy,q1,mx,fz,t\n6,20,1,5,2,10,4,3,0\n", {.outputs = OutputKind::wrench});
    CHECK(recording.position.values == Values{10, 20});
    CHECK(recording.output.values == Values{1, 2, 3, 4, 5, 6});
}

TEST_CASE("joint numbers are compared as numbers and q011 is not joint 11") {
    const Recording recording = read("t,q011,q10,q9,q8,q7,q6,q5,q4,q3,q2,q1\n0,0,10,9,8,7,6,5,4,3,2,1\n");
    CHECK(recording.position.values == Values{1, 2, 3, 4, 5, 6, 7, 8, 9, 10});
    CHECK(recording.ignored_columns == Names{"q011"});
}

TEST_CASE("harmless differences in the text do not matter") {
    const std::string content = GENERATE("t,q1\n0,1\n0.5,2\n",                 //
                                         "t,q1\n0,1\n0.5,2",                   //
                                         "t,q1\r\n0,1\r\n0.5,2\r\n",           //
                                         "\xef\xbb\xbft,q1\n0,1\n0.5,2\n",     //
                                         " t ,\tq1\n 0, 1 \n+0.5\t,+2\n",      //
                                         "\"t\",\" q1\"\n0,1\n5e-1,2.0\n",     //
                                         "\xef\xbb\xbf\"t\",q1\n0,1\n0.5,2\n", //
                                         "t,q1\n0,1\n0.5,2\n\n \r\n\n");
    CAPTURE(content);
    const Recording recording = read(content);
    CHECK(recording.time_s == Values{0, 0.5});
    CHECK(recording.position.values == Values{1, 2});
}

TEST_CASE("the locale of the program does not affect reading") {
    struct Comma : std::numpunct<char> {
        char do_decimal_point() const override { return ','; }
    };
    const std::locale previous = std::locale::global(std::locale(std::locale::classic(), new Comma));
    const Recording recording = read("t,q1\n0,1.5\n");
    std::locale::global(previous);
    CHECK(recording.position.values == Values{1.5});
}

TEST_CASE("time is rounded to nanoseconds and may be negative or as large as the present date") {
    const Recording recording = read("t,q1\n-0.0000000016,1\n-1e-9,1\n1e-9,1\n1700000000.5,1\n9.2e9,1\n");
    CHECK(recording.time_ns ==
          std::vector<std::int64_t>{-2, -1, 1, 1'700'000'000'500'000'000, 9'200'000'000'000'000'000});
}

TEST_CASE("a row range selects rows of the file and does not read others") {
    const std::string content = "t,q1\nbad\n1,1\n2,2\n3,3\nbad\n";
    const auto [range, positions] =
        GENERATE(table<std::string, Values>({{"1:4", {1, 2, 3}}, {"2:3", {2}}, {"3:4", {3}}}));
    const Recording recording = read(content, {.rows = parse_row_range(range)});
    CHECK(recording.position.values == positions);
    CHECK(recording.gap_before.front() == 1);
    CHECK(read("t,q1\n0,0\n1,1\n", {.rows = parse_row_range("1:")}).position.values == Values{1});
    CHECK(read("t,q1\n0,0\n1,1\n", {.rows = parse_row_range(":2")}).position.values == Values{0, 1});
    CHECK(read("t,q1\nbad\n1,1\nbad\n3,3\nbad\n5,5\n", {.rows = parse_row_range("1::2")}).position.values ==
          Values{1, 3, 5});
}

TEST_CASE("skipped rows are counted by reason and leave a gap") {
    const std::string content = "t,q1,note\n"
                                "0,0,\n"
                                "1,1\n"     // ragged
                                "2,2,\n"    //
                                "3,3,\n"    //
                                "4,x,\n"    // not a number
                                "5,,\n"     // not a number
                                "6,inf,\n"  // out of range
                                "1e10,6,\n" // out of range
                                "3,7,\n"    // time not increasing
                                "8,8,nan\n"
                                "\n" // ragged
                                "9,9,\n"
                                "\n";
    const Recording recording = read(content, {.skip_bad_rows = true});
    CHECK(recording.position.values == Values{0, 2, 3, 8, 9});
    CHECK(recording.gap_before == Flags{1, 1, 0, 1, 1});
    CHECK(describe(recording.skipped) ==
          "7 rows skipped: 2 ragged, 2 not a number, 2 out of range, 1 time not increasing");
}

TEST_CASE("a row range counts skipped rows too") {
    const Recording recording =
        read("t,q1\n0,0\nx,1\n2,2\n\n4,4\n", {.rows = parse_row_range("1:5"), .skip_bad_rows = true});
    CHECK(recording.position.values == Values{2, 4});
    CHECK(recording.skipped.total() == 2);
    CHECK(recording.gap_before == Flags{1, 1});
}

TEST_CASE("rows after the requested range are not read") {
    const std::string endless(std::size_t{2} << 20U, '1');
    CHECK(read("t,q1\n0,0\n1,1\n" + endless, {.rows = parse_row_range(":2")}).row_count() == 2);
    const Recording recording =
        read("t,q1\n0,0\n\n\n\n4,4\n", {.rows = parse_row_range(":2"), .skip_bad_rows = true});
    CHECK(recording.row_count() == 1);
    CHECK(recording.skipped.total() == 1);
}

TEST_CASE("several recordings are read in order with the same row range") {
    const TemporaryDirectory directory;
    const std::vector<std::filesystem::path> paths{directory.write("b.csv", "t,q1\n0,1\n1,2\n"),
                                                   directory.write("a.csv", "q1,t\n3,0\n4,1\n5,2\n")};
    const std::vector<Recording> recordings = read_recordings(paths, {.rows = parse_row_range("1:")});
    REQUIRE(recordings.size() == 2);
    CHECK(recordings[0].position.values == Values{2});
    CHECK(recordings[1].position.values == Values{4, 5});
    CHECK(recordings[1].gap_before == Flags{1, 0});
}

TEST_CASE("several recordings must have the same columns") {
    const TemporaryDirectory directory;
    const std::string one = directory.write("1.csv", "t,q1,q2,qd1,qd2\n0,1,1,1,1\n");
    const std::string two = directory.write("2.csv", "t,q1,qd1\n0,1,1\n");
    const std::string three = directory.write("3.csv", "t,q1,q2\n0,1,1\n");
    const std::string four = directory.write("4.csv", "t,q1,q2,qd1,qd2,qdd1,qdd2\n0,1,1,1,1,1,1\n");
    const auto read_both = [](const std::string& first, const std::string& second) {
        return read_recordings(std::vector<std::filesystem::path>{first, second},
                               {.velocity = true, .acceleration = true});
    };
    CHECK_THROWS_MATCHES(
        read_both(one, two), InputError,
        Catch::Matchers::Message(two + ": expected the columns of " + one + ", q1, q2, found q1"));
    CHECK_THROWS_MATCHES(
        read_both(one, three), InputError,
        Catch::Matchers::Message(three + ": expected the columns of " + one + ", qd1, qd2, found none"));
    CHECK_THROWS_MATCHES(
        read_both(one, four), InputError,
        Catch::Matchers::Message(four + ": expected the columns of " + one + ", none, found qdd1, qdd2"));
    const std::string torques = directory.write("5.csv", "t,q1,q2,tau1,tau2\n0,1,1,1,1\n");
    const std::string currents = directory.write("6.csv", "t,q1,q2,i1,i2\n0,1,1,1,1\n");
    CHECK_THROWS_MATCHES(
        read_recordings(std::vector<std::filesystem::path>{torques, currents},
                        {.output_choices = {OutputKind::joint_torque, OutputKind::motor_current}}),
        InputError,
        Catch::Matchers::Message(currents + ": expected the columns of " + torques +
                                 ", tau1, tau2, found i1, i2"));
}
