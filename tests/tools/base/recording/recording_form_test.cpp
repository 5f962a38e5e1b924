// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/base/text/error.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace recording_form_test {

using namespace dfdyn::tools;
using dfdyn::tests::TemporaryDirectory;
using Names = std::vector<std::string>;
using Values = std::vector<double>;
using Times = std::vector<std::int64_t>;

Recording read(std::string_view content, const ReadOptions& options = {}) {
    const TemporaryDirectory directory;
    return read_recording(directory.write("log.csv", content), options);
}

ReadOptions columns(std::string_view patterns, Names joint_names = {}) {
    ReadOptions options;
    options.columns = parse_column_patterns(patterns);
    options.joint_names = std::move(joint_names);
    return options;
}

ReadOptions torques(std::string_view patterns, Names joint_names = {}) {
    ReadOptions options = columns(patterns, std::move(joint_names));
    options.outputs = OutputKind::joint_torque;
    return options;
}

/// The message about a file with `content`, without its path, or "" if it is read.
std::string refusal(std::string_view content, const ReadOptions& options) {
    const TemporaryDirectory directory;
    const std::string path = directory.write("log.csv", content);
    try {
        read_recording(path, options);
        return "";
    } catch (const InputError& error) {
        return std::string(error.what()).substr(path.size() + 1);
    }
}

constexpr std::string_view joint_states =
    "stamp,/js/elbow/position,/js/base/position,/js/hand/position,/js/base/effort,/js/elbow/effort\n"
    "0,2,1,9,10,20\n"
    "1,4,3,9,30,40\n";

TEST_CASE("columns named by joints are read in the order of the chain and the others are ignored") {
    const Recording recording =
        read(joint_states, torques("q=/js/*/position,tau=/js/*/effort", {"base", "elbow"}));
    CHECK(recording.position.names == Names{"q1", "q2"});
    CHECK(recording.position.values == Values{1, 2, 3, 4});
    CHECK(recording.output.names == Names{"tau1", "tau2"});
    CHECK(recording.output.values == Values{10, 20, 30, 40});
    CHECK(recording.ignored_columns == Names{"/js/hand/position"});
}

TEST_CASE("without a chain columns named by joints keep the order of the header") {
    CHECK(read(joint_states, columns("q=/js/*/position")).position.values == Values{2, 1, 9, 4, 3, 9});
}

TEST_CASE("columns with numbers are ordered by number") {
    std::string header = "t";
    std::string row = "0";
    for (int joint = 11; joint >= 0; --joint) {
        header += ",position[" + std::to_string(joint) + "]";
        row += "," + std::to_string(joint);
    }
    const Recording recording = read(header + "\n" + row + "\n", columns("q=position[*]", {"base", "elbow"}));
    CHECK(recording.position.values == Values{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
}

TEST_CASE("columns are listed one by one in any order and a given quantity hides its own names") {
    const Recording recording = read("time,q1,arm a,arm b\n5,9,1,2\n", columns("q=arm b|arm a"));
    CHECK(recording.position.values == Values{2, 1});
    CHECK(recording.ignored_columns == Names{"q1"});
    CHECK(recording.time_s == Values{5});
}

TEST_CASE("a wrench is found by the names of its components") {
    ReadOptions options = columns("wrench=ft.*");
    options.outputs = OutputKind::wrench;
    const Recording recording = read("t,q1,ft.mx,ft.my,ft.mz,ft.fx,ft.fy,ft.fz\n0,0,4,5,6,1,2,3\n", options);
    CHECK(recording.output.names == Names{"fx", "fy", "fz", "mx", "my", "mz"});
    CHECK(recording.output.values == Values{1, 2, 3, 4, 5, 6});
}

TEST_CASE("a pattern that does not fit the header is rejected with what would be right") {
    const std::string header = "t,a1,a2,a4,b_base,b_elbow\n0,0,0,0,0,0\n";
    const auto [patterns, joints, message] = GENERATE(table<std::string, Names, std::string>({
        {"q=a*", {}, "expected numbers that follow each other in place of *, found 4 but no 3"},
        {"q=c*",
         {},
         "expected columns that match, found none; the header has t, a1, a2, a4, b_base, b_elbow"},
        {"q=b_bsae",
         {},
         "expected the column \"b_bsae\", found none (did you mean \"b_base\"?); the header has t, a1, a2, "
         "a4, "
         "b_base, b_elbow"},
        {"q=b_*",
         {"base", "elbow", "wrist"},
         "expected a column for each joint of the chain, base, elbow, wrist, found none for wrist"},
        {"q=b_*",
         {"bases", "elbow"},
         "expected a column for each joint of the chain, bases, elbow, found none for bases (did you mean "
         "\"base\"?)"},
        {"q=b_*",
         {"x", "y"},
         "expected numbers or joints of the chain (x, y) in place of *, found base, elbow"},
        {"t=b_*", {}, "expected 1 columns, found 2"},
    }));
    CHECK(refusal(header, columns(patterns, joints)) == "1: --columns " + patterns + ": " + message);
    CHECK(refusal(header, torques("q=a1|a2,tau=a2|a4")) ==
          "1: --columns: expected one quantity for each column, found \"a2\" for q and tau");
    CHECK(refusal(header, torques("q=a1|a2,tau=a4")) ==
          "1: expected columns t, q1, q2, tau1, tau2, found no tau2; the header has t, a1, a2, a4, b_base, "
          "b_elbow (--columns assigns columns to quantities)");
}

TEST_CASE("patterns and units that cannot be understood are rejected") {
    const auto [patterns, message] = GENERATE(table<std::string, std::string>({
        {"q", "--columns: expected QUANTITY=PATTERN, such as q=position[*], found \"q\""},
        {"q=", "--columns: expected QUANTITY=PATTERN, such as q=position[*], found \"q=\""},
        {"q=a*,x=b", "--columns: expected a quantity, one of t, q, qd, qdd, tau, i, wrench, found \"x\""},
        {"q=a*,q=b", "--columns: expected each quantity once, found \"q\""},
        {"q=a*b*", "--columns: expected one * in a pattern, found \"a*b*\""},
    }));
    CHECK_THROWS_MATCHES(parse_column_patterns(patterns), InputError, Catch::Matchers::Message(message));
    const auto [units, wrong_unit] = GENERATE(table<std::string, std::string>({
        {"deg", "--units: expected QUANTITY=UNIT with a quantity t, q, qd, qdd, tau, i or wrench, found "
                "\"deg\""},
        {"q=dge",
         "--units q: expected one of deg, m, mm, mrad, rad, turn, ticks:N (N per turn, not 0), found "
         "\"dge\" (did you mean \"deg\"?)"},
        {"q=ticks:0",
         "--units q: expected one of deg, m, mm, mrad, rad, turn, ticks:N (N per turn, not 0), found "
         "\"ticks:0\""},
        {"t=min", "--units t: expected one of ms, ns, s, us, found \"min\""},
    }));
    CHECK_THROWS_MATCHES(parse_units(units), InputError, Catch::Matchers::Message(wrong_unit));
}

TEST_CASE("units are converted for each quantity and each joint") {
    ReadOptions options;
    options.velocity = true;
    options.outputs = OutputKind::motor_current;
    options.units = parse_units("q=deg|ticks:-4096,i=mA");
    const Recording recording = read("t,q1,q2,qd1,qd2,i1,i2\n0,180,1024,90,2048,5,500\n", options);
    const double pi = std::numbers::pi;
    const Values expected{pi, -pi / 2, pi / 2, -pi, 0.005, 0.5};
    const Values found{recording.position.values[0], recording.position.values[1],
                       recording.velocity.values[0], recording.velocity.values[1],
                       recording.output.values[0],   recording.output.values[1]};
    for (std::size_t k = 0; k < expected.size(); ++k) {
        CAPTURE(k);
        CHECK(std::abs(found[k] - expected[k]) < 1e-15);
    }
    options.units = parse_units("q=deg|deg|deg");
    CHECK_THROWS_MATCHES(
        read("t,q1,q2,i1,i2\n0,0,0,0,0\n", options), InputError,
        Catch::Matchers::Message("--units q: expected one unit or 2, one per column, found 3"));
}

TEST_CASE("units that joints of a robot cannot have are rejected") {
    const std::vector<bool> turning_and_sliding{false, true};
    const std::string one_per_joint = "--units q: expected one unit per joint, separated by |, because some "
                                      "joints are prismatic and others turn, found one unit";
    const std::string angle = "--units q: expected m or mm for the prismatic joint 2, found a unit of angles";
    for (const auto& [units, message] :
         {std::pair("q=deg", one_per_joint), std::pair("q=mm", one_per_joint), std::pair("q=deg|deg", angle),
          std::pair("q=rad|ticks:4096", angle)}) {
        CAPTURE(units);
        CHECK_THROWS_MATCHES(check_units(parse_units(units), turning_and_sliding), InputError,
                             Catch::Matchers::Message(message));
    }
    const std::string length =
        "--units q: expected a unit of angles for joint 1, which turns, found mm (mrad "
        "are thousandths of a radian)";
    CHECK_THROWS_MATCHES(check_units(parse_units("q=mm|mm"), turning_and_sliding), InputError,
                         Catch::Matchers::Message(length));
    CHECK_THROWS_MATCHES(check_units(parse_units("q=mm"), {false, false}), InputError,
                         Catch::Matchers::Message(length));
    CHECK_THROWS_AS(check_units(parse_units("q=rad|mrad"), turning_and_sliding), InputError);
    CHECK_THROWS_AS(check_units(parse_units("qd=turn"), {true, true}), InputError);
    CHECK_NOTHROW(check_units(parse_units("q=mrad|mm"), turning_and_sliding));
    CHECK_NOTHROW(check_units(parse_units("q=mrad"), {false, false}));
    CHECK(unit_factor(parse_units("q=mrad"), "qd", 0, 2) == 1e-3);
    CHECK_NOTHROW(check_units(parse_units("q=mm"), {}));
    CHECK_NOTHROW(check_units(parse_units("q=deg|mm,i=mA"), turning_and_sliding));
    CHECK_NOTHROW(check_units(parse_units("q=rad,t=ms"), turning_and_sliding));
    CHECK_NOTHROW(check_units(parse_units("q=mm"), {true, true}));
    CHECK_NOTHROW(check_units(parse_units("q=deg"), {false, false}));
    CHECK_NOTHROW(check_units(parse_units("q=deg"), {}));
}

TEST_CASE("the time is in any of the usual columns and units") {
    const auto [content, times] = GENERATE(table<std::string, Times>({
        {"time,q1\n0.5,0\n", {500'000'000}},
        {"timestamp,q1\n1.5,0\n", {1'500'000'000}},
        {"time,stamp,t,q1\n1,2,3,0\n", {3'000'000'000}},
        {"stamp,time,q1\n1,2,0\n", {2'000'000'000}},
        {"t,q1\n1700000000123456789,0\n1700000000123456790,0\n",
         {1'700'000'000'123'456'789, 1'700'000'000'123'456'790}},
        {"t,q1\n1700000000123456,0\n", {1'700'000'000'123'456'000}},
        {"t,q1\n1700000000123,0\n", {1'700'000'000'123'000'000}},
        {"t,q1\n1700000000.125,0\n", {1'700'000'000'125'000'000}},
    }));
    CAPTURE(content);
    CHECK(read(content).time_ns == times);
    ReadOptions options;
    options.units = parse_units("t=us");
    CHECK(read("t,q1\n0,0\n1000.5,0\n", options).time_ns == Times{0, 1'000'500});
    options.units = parse_units("t=s");
    CHECK_THAT(refusal("t,q1\n1700000000123,0\n", options),
               Catch::Matchers::StartsWith("2: column t: expected a time within 9.2e9 s of 0"));
    CHECK_THAT(refusal("stamp,q1\n1,0\n1,0\n", {}),
               Catch::Matchers::StartsWith("3: column stamp: expected a time"));
}

TEST_CASE("a recording in another unit of time than seconds says so") {
    CHECK(read("t,q1\n0,0\n").notes.empty());
    CHECK(read("stamp,q1\n1700000000123,0\n").notes ==
          Names{"column stamp: times from 1970 on, in units of 0.001 s (--units t=s keeps them)"});
}

TEST_CASE("separators, quotes, comments and decimal commas of other programs are read") {
    const std::string content = GENERATE(
        "t;q1;q2\n0;1.5;-2\n1;3;4\n", "t\tq1\tq2\n0\t1.5\t-2\n1\t3\t4\n", "t;q1;q2\n0;1,5;-2\n1,0;3;4\n",
        "\"t\";\"q1\";\"q2\"\n\"0\";\"1,5\";\"-2\"\n1;3;4\n",
        "t,q1,q2,\"a,b\"\n0,1.5,-2,\"x,y\"\n1,3,4, \"\" \n", "# by hand\n# t,q1,q2\n0,1.5,-2\n1,3,4\n",
        "# by hand\nt,q1,q2\n# first\n0,1.5,-2\n#\n1,3,4\n", "# t;q1;q2\n0;1,5;-2\n1;3;4\n");
    CAPTURE(content);
    const Recording recording = read(content);
    CHECK(recording.time_s == Values{0, 1});
    CHECK(recording.position.values == Values{1.5, -2, 3, 4});
}

TEST_CASE("a row under a header in a comment is counted as the first row") {
    ReadOptions options;
    options.rows = parse_row_range("1:");
    CHECK(read("# t,q1\n0,1\n1,2\n2,3\n", options).position.values == Values{2, 3});
    CHECK_THAT(refusal("# t,q1\n0,1\n\n# here\n1,x\n", {}),
               Catch::Matchers::StartsWith("3: expected 2 fields, found an empty line"));
    CHECK_THAT(refusal("# t,q1\n0,1\n# here\n1,x\n", {}),
               Catch::Matchers::StartsWith("4: column q1: expected a number"));
}

TEST_CASE("header and patterns of random bytes are read or rejected in one line") {
    DFDYN_SEEDED_ENGINE(engine);
    constexpr std::string_view letters = "tq12*|[]=,;\t\"# ab\n";
    for (int count = 0; count < 2000; ++count) {
        std::string content;
        std::string pattern;
        for (std::size_t length = engine() % 40; length > 0; --length) {
            content += letters[engine() % letters.size()];
        }
        for (std::size_t length = engine() % 12; length > 0; --length) {
            pattern += letters[engine() % letters.size()];
        }
        CAPTURE(content, pattern);
        try {
            read(content, columns("q=" + pattern, {"a", "b"}));
        } catch (const InputError& error) {
            CHECK(std::string_view(error.what()).find('\n') == std::string_view::npos);
        }
    }
}

} // namespace recording_form_test
