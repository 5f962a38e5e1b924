// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/base/recording/recording.hpp"
#include "tools/base/text/error.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::TemporaryDirectory;

/// The end of a message about missing columns.
const std::string advice = " (--columns assigns columns to quantities)";

const ReadOptions torque{.outputs = OutputKind::joint_torque, .velocity = true, .acceleration = true};

/// The error message about a file with `content`, without its path, or nothing if the file can be read.
std::optional<std::string> refusal(const TemporaryDirectory& directory, std::string_view content,
                                   const ReadOptions& options) {
    const std::string path = directory.write("log.csv", content);
    try {
        const Recording recording = read_recording(path, options);
        CHECK(recording.row_count() > 0);
        CHECK(recording.position.values.size() == recording.row_count() * recording.joint_count());
        return std::nullopt;
    } catch (const InputError& error) {
        const std::string message = error.what();
        CHECK_THAT(message, Catch::Matchers::StartsWith(path + ":"));
        return message.substr(path.size() + 1);
    }
}

struct Case {
    std::string content;
    std::string message;
};

void check_refused(const std::vector<Case>& cases, const ReadOptions& options) {
    const TemporaryDirectory directory;
    for (const Case& one : cases) {
        INFO(one.content);
        CHECK(refusal(directory, one.content, options) == one.message);
    }
}

bool is_one_line(const std::string& text) {
    return std::all_of(text.begin(), text.end(), [](char byte) { return byte >= ' ' && byte <= '~'; });
}

/// Checks that the file is read or rejected with one line. A crash or another exception fails the test.
void check_survived(const TemporaryDirectory& directory, const std::string& content) {
    for (const bool skip : {false, true}) {
        ReadOptions options = torque;
        options.skip_bad_rows = skip;
        const auto message = refusal(directory, content, options);
        INFO(content << "\n" << message.value_or("read"));
        CHECK(is_one_line(message.value_or("")));
    }
}

} // namespace

TEST_CASE("a bad header is rejected with the expected and the found text") {
    const std::string needed = "1: expected columns t, q1, q2, tau1, tau2, found no ";
    check_refused(
        {
            {"", " expected a header of column names, found an empty file"},
            {"t,q1,tau1\n", " expected rows below the header, found none"},
            {"t,q1,tau1\n\n \n", " expected rows below the header, found none"},
            {"\n",
             "1: expected columns t, q1, tau1, found no t, q1, tau1; the header has column 1 (unnamed)" +
                 advice},
            {"t,q1,q2,tau1\n0,0,0,0\n", needed + "tau2; the header has t, q1, q2, tau1" + advice},
            {"q1,q2,x\n0,0,0\n", needed + "t, tau1, tau2; the header has q1, q2, x" + advice},
            {"# t,q1,q2,tau1,tau2\n", " expected rows below the header, found none"},
            {"# note\n",
             "1: expected columns t, q1, tau1, found no t, q1, tau1; the header has note" + advice},
            {"0,1.5\n0,0\n",
             "1: expected columns t, q1, tau1, found no t, q1, tau1; the header has 0, 1.5" + advice},
            {"t,tau1\n0,0\n",
             "1: expected columns t, q1, tau1, found no q1; the header has t, tau1" + advice},
            {"T,Q1,tau1\n0,0,0\n", "1: expected columns t, q1, tau1, found no t, q1 (did you mean \"T\" for "
                                   "t, \"Q1\" for q1: --columns q=Q*,t=T?); the header has T, "
                                   "Q1, tau1" +
                                       advice},
            {"t,q1,q2,tau1,tua2\n",
             needed + "tau2 (did you mean \"tua2\" for tau2?); the header has t, q1, q2, tau1, tua2" +
                 advice},
            {"t,q1,q2,q4,tau1\n",
             "1: expected joint positions q1, q2, ... without a hole, found q4 but no q3"},
            {"t,q2,tau1\n", "1: expected joint positions q1, q2, ... without a hole, found q2 but no q1"},
            {"t,q0,q1\n",
             "1: expected joint positions q1, q2, ... without a hole, found q0 (--columns q=q*)"},
            {"t,q1,q4294967297\n",
             "1: expected joint positions q1, q2, ... without a hole, found q4294967297 but no q2"},
            {"t,q1,q2,tau1,tau2,qd1\n",
             "1: expected columns qd1, qd2, found no qd2; the header has t, q1, q2, tau1, "
             "tau2, qd1" +
                 advice},
            {"t,q1,q2,tau1,tau2,qdd2\n",
             "1: expected columns qdd1, qdd2, found no qdd1; the header has t, q1, q2, "
             "tau1, tau2, qdd2" +
                 advice},
            {"t,q1,tau1,q1\n", "1: expected each column once, found \"q1\" twice"},
            {"t,q1,tau1,x,x\n", "1: expected each column once, found \"x\" twice"},
            {"t,q1,\"tau1\n",
             "1: expected a column name, found \"\"tau1\" (a quoted name ends with a quote and holds "
             "none)"},
            {"t,q1,tau1,\"\n",
             "1: expected a column name, found \"\"\" (a quoted name ends with a quote and holds none)"},
            {"t,q1,tau1\x7f\n", "1: expected a header of column names, found no text: \"t,q1,tau1\\x7f\""},
            {"t q1 tau1\n",
             "1: expected column names separated by commas, semicolons or tabs, found \" \" between "
             "them"},
            {"\x7f"
             "ELF\x02\x01",
             "1: expected a header of column names, found no text: \"\\x7fELF\\x02\\x01\""},
            {std::string("t\0,q1\n", 6),
             "1: expected a header of column names, found no text: \"t\\x00,q1\""},
            {std::string("\xff\xfet\0,\0", 6),
             "1: expected a header of column names, found no text: \"\\xff\\xfet\\x00,\\x00\" (UTF-16: save "
             "it as UTF-8, or iconv "
             "-f UTF-16 -t UTF-8)"},
            {"t,q1,tau1\r0,0,0\r1,0,0\r", "1: expected a header of column names, found no text: "
                                          "\"t,q1,tau1\\x0d0,0,0\\x0d1,0,0\" (lines end with CR "
                                          "alone: convert them to LF, such as with tr '\\r' '\\n')"},
            {"(1600000000.000000) can0 181#00\n",
             "1: expected a header of column names, found a line of a candump log, which needs --bus (dfdyn "
             "replay)"},
            {"t,q0,q1,qd0,qd1,tau0,tau1\n",
             "1: expected joint positions q1, q2, ... without a hole, found q0 "
             "(--columns 'q=q0|q1,qd=qd*,tau=tau*')"},
            {"t [s],q1 [rad],tau1 (Nm)\n", "1: expected columns t, q1, tau1, found no t, q1, tau1 (did you "
                                           "mean \"t [s]\" for t, \"q1 [rad]\" "
                                           "for q1, \"tau1 (Nm)\" for tau1: --columns \"q=q* [rad],t=t "
                                           "[s],tau=tau* (Nm)\"?); the header has t "
                                           "[s], q1 [rad], tau1 (Nm)" +
                                               advice},
            {"t,q1\x1b[2J\n", "1: expected a header of column names, found no text: \"t,q1\\x1b[2J\""},
        },
        torque);
}

TEST_CASE("a header that does not fit the chain is rejected") {
    ReadOptions two_joints;
    two_joints.joint_count = 2;
    check_refused(
        {
            {"t,q1\n0,0\n", "1: expected columns t, q1, q2, found no q2; the header has t, q1" + advice},
            {"t,q1,q2,q3\n0,0,0,0\n", "1: expected 2 joint positions, as the chain has joints, found 3"},
        },
        two_joints);
}

TEST_CASE("a header with very many columns is rejected with a short message") {
    std::string header = "t";
    for (int column = 0; column < 10'000; ++column) {
        header += ",x" + std::to_string(column);
    }
    const TemporaryDirectory directory;
    const auto message = refusal(directory, header + "\n", torque);
    REQUIRE(message);
    CHECK_THAT(*message, Catch::Matchers::EndsWith("x28, ... (10001 in all)" + advice));
    CHECK(message->size() < 450);
}

TEST_CASE("a header with more joints than a model can have is rejected") {
    const auto header = [](std::size_t joints) {
        std::string line = "t";
        for (const char* const quantity : {"q", "tau"}) {
            for (const std::string& name : joint_names(quantity, joints)) {
                line += "," + name;
            }
        }
        return line + "\n";
    };
    const TemporaryDirectory directory;
    CHECK_THAT(refusal(directory, header(65), torque).value(),
               Catch::Matchers::EndsWith("1: expected at most 64 joints, found 65"));
    CHECK_THAT(refusal(directory, header(64), torque).value(),
               Catch::Matchers::EndsWith("expected rows below the header, found none"));
}

TEST_CASE("a bad row is rejected with line and column and the expected and the found text") {
    const std::string head = "t,q1,tau1,x\n0,0,0,\n";
    const std::string number = ": expected a number, found ";
    const std::string finite = ": expected a finite number in the range of a double, found ";
    check_refused(
        {
            {head + "1,1,1\n", "3: expected 4 fields, found 3"},
            {head + "1,1,1,,\n", "3: expected 4 fields, found 5"},
            {head + "1\n", "3: expected 4 fields, found 1"},
            {head + "1,1,1,\n2,2", "4: expected 4 fields, found 2"},
            {head + "\n\n1,1,1,\n", "3: expected 4 fields, found an empty line"},
            {head + "1,abc,1,\n", "3: column q1" + number + "\"abc\""},
            {head + "1,1,,\n", "3: column tau1" + number + "an empty field"},
            {head + "1,1, ,\n", "3: column tau1" + number + "an empty field"},
            {head + "1,\"1\"2,1,\n", "3: column q1" + number + "\"\"1\"2\""},
            {head + "1,\"1,1,\n", "3: column q1" + number + "\"\"1\""},
            {head + "1,0x10,1,\n", "3: column q1" + number + "\"0x10\""},
            {head + "1,1 2,1,\n", "3: column q1" + number + "\"1 2\""},
            {head + "1,1;2,1,\n", "3: column q1" + number + "\"1;2\""},
            {head + std::string("1,1\0,1,\n", 8), "3: column q1" + number + "\"1\\x00\""},
            {head + "1,\x1b[31m\xe2\x82\xac,1,\n", "3: column q1" + number + "\"\\x1b[31m\\xe2\\x82\\xac\""},
            {head + "1," + std::string(1000, '9') + "x,1,\n",
             "3: column q1" + number + "\"" + std::string(40, '9') + "...\""},
            {head + "1,1\r,1,\n", "3: column q1" + number + "\"1\\x0d\""},
            {head + "1,nan,1,\n", "3: column q1" + finite + "\"nan\""},
            {head + "1,1,-inf,\n", "3: column tau1" + finite + "\"-inf\""},
            {head + "1,1,1e999,\n", "3: column tau1" + finite + "\"1e999\""},
            {head + "nan,1,1,\n", "3: column t" + finite + "\"nan\""},
            {head + "0,1,1,\n", "3: column t: expected a time after that of the row before, 0, found 0"},
            {head + "1.5,1,1,\n1.25,1,1,\n",
             "4: column t: expected a time after that of the row before, 1.5, found 1.25"},
            {head + "1e-10,1,1,\n",
             "3: column t: expected a time after that of the row before, 0, found 1e-10"},
            {head + "1e10,1,1,\n", "3: column t: expected a time within 9.2e9 s of 0, found 1e+10 (--units "
                                   "t=ns if they are nanoseconds)"},
            {"t,q1,tau1\n-1e10,1,1\n", "2: column t: expected a time within 9.2e9 s of 0, found -1e+10 "
                                       "(--units t=ns if they are nanoseconds)"},
            {head + std::string((std::size_t{1} << 20U) + 1, '1'),
             "3: expected a line of at most 1048576 bytes, found a longer one"},
        },
        torque);
}

TEST_CASE("a row range outside the recording is rejected") {
    const std::string three_rows = "t,q1,tau1\n0,0,0\n1,0,0\n2,0,0\n";
    const auto [range, needed] =
        GENERATE(table<std::string, std::string>({{"3:", "4"}, {"100:", "101"}, {":4", "4"}, {"1:9", "9"}}));
    ReadOptions options = torque;
    options.rows = parse_row_range(range);
    const TemporaryDirectory directory;
    CHECK(refusal(directory, three_rows, options) ==
          " --rows: expected at least " + needed + " rows in the recording, found 3");
}

TEST_CASE("a recording without any usable row is rejected") {
    ReadOptions options = torque;
    options.skip_bad_rows = true;
    check_refused({{"t,q1,tau1\n0,x,0\n1\n",
                    " expected a usable row, found none: 2 rows skipped: 1 ragged, 1 not a number"}},
                  options);
}

TEST_CASE("a recording that cannot be read is rejected with the reason of the system") {
    const TemporaryDirectory directory;
    const std::string path = directory.path().string();
    CHECK_THROWS_MATCHES(read_recording(path, torque), InputError,
                         Catch::Matchers::Message(path + ": cannot read: Is a directory"));
    CHECK_THROWS_MATCHES(
        read_recording(path + "/no\nne", torque), InputError,
        Catch::Matchers::Message(path + "/no\\x0ane: cannot open: No such file or directory"));
}

TEST_CASE("every prefix of a valid recording is read or rejected with one line") {
    const std::string whole = "\xef\xbb\xbft,\"q1\",q2,qd1,qd2,tau1,tau2,x\r\n"
                              "0.000,-1.5,+2e-3,0.1,0.2,12.5,-7,ok\r\n"
                              "0.008,-1.4,3,0.3,0.4,12.6,-7.25,\r\n";
    const TemporaryDirectory directory;
    for (std::size_t length = 0; length <= whole.size(); ++length) {
        check_survived(directory, whole.substr(0, length));
    }
}

TEST_CASE("a recording with random bytes changed is read or rejected with one line") {
    DFDYN_SEEDED_ENGINE(engine);
    const std::string whole = "t,q1,q2,tau1,tau2\n0.0,1,2,3,4\n0.1,1,2,3,4\n0.2,1,2,3,4\n";
    const TemporaryDirectory directory;
    for (int count = 0; count < 500; ++count) {
        std::string content = whole;
        for (int change = 0; change < 1 + count % 4; ++change) {
            content.at(engine() % content.size()) = static_cast<char>(engine() % 256);
        }
        check_survived(directory, content);
    }
}
