// SPDX-License-Identifier: Apache-2.0
#include "tools/can/log/candump_log.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tools/base/text/error.hpp"

#include <array>
#include <vector>

namespace {

using dfdyn::hal::Frame;
using dfdyn::hal::ReplayBus;
using dfdyn::hal::ReplayEntry;
using dfdyn::tests::TemporaryDirectory;
using dfdyn::tools::CandumpLog;
using dfdyn::tools::InputError;

using Ids = std::vector<std::uint32_t>;

Ids ids_of(CandumpLog& log) {
    Ids ids;
    ReplayEntry entry;
    while (log.next(entry)) {
        ids.push_back(entry.frame.id);
    }
    return ids;
}

const std::string two_interfaces = "(1.000000) can0 001#\n"
                                   "(1.000100) can1 002#\n"
                                   "(1.000200) can0 003#\n"
                                   "DROPCOUNT: dropped 2 CAN frames on 'can1' socket (total drops 2)\n"
                                   "(1.000300) can1 004#\n";

} // namespace

TEST_CASE("a candump log is replayed with lost frames and error frames and its clock") {
    const TemporaryDirectory directory;
    CandumpLog log(directory.write("run.log",
                                   "# a comment\n"
                                   "(5.000000) can0 101#01\n"
                                   "\n"
                                   "DROPCOUNT: dropped 2 CAN frames on 'can0' socket (total drops 2)\n"
                                   "DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 5)\n"
                                   "(5.001000) can0 102#02\n"
                                   "(5.002000) can0 20000040#0000000000000000\n"
                                   "DROPCOUNT: dropped 4 CAN frames on 'can0' socket (total drops 9)\n"));
    ReplayBus bus(log);
    std::array<Frame, 8> room;
    CHECK(bus.now_ns() == 5'000'000'000);
    CHECK(bus.drain(room).size() == 1);
    CHECK(bus.counters().dropped == 0);
    bus.advance_to(bus.next_stamp_ns());
    CHECK(bus.now_ns() == 5'001'000'000);
    REQUIRE(bus.drain(room).size() == 1);
    CHECK(room[0].id == 0x102);
    CHECK(room[0].data[0] == 2);
    CHECK(bus.counters().dropped == 5);
    bus.advance_to(bus.next_stamp_ns());
    CHECK(bus.drain(room).size() == 1);
    CHECK(bus.state() == dfdyn::hal::BusState::off);
    CHECK(bus.ended());
    CHECK(bus.counters().dropped == 9);
    CHECK_NOTHROW(log.check());
}

TEST_CASE("one interface of a log with several must be chosen") {
    const TemporaryDirectory directory;
    const auto path = directory.write("run.log", two_interfaces);
    CandumpLog first(path, "can0");
    CHECK(ids_of(first) == Ids{1, 3});
    CHECK_NOTHROW(first.check());
    CandumpLog second(path, "can1");
    ReplayEntry entry;
    REQUIRE(second.next(entry));
    CHECK(entry.dropped_before == 0);
    REQUIRE(second.next(entry));
    CHECK(entry.frame.id == 4);
    CHECK(entry.dropped_before == 2);
    CandumpLog none(path, "can2");
    CHECK(ids_of(none).empty());
    CandumpLog unchosen(path);
    CHECK(ids_of(unchosen) == Ids{1});
    CHECK_THROWS_MATCHES(
        unchosen.check(), InputError,
        Catch::Matchers::Message(path.string() + ":2: expected frames of one interface, or one of them to be "
                                                 "chosen, found \"can1\" after \"can0\""));
}

TEST_CASE("a malformed line ends the log permanently with its position and the expected text") {
    const std::pair<std::string, std::string> cases[] = {
        {"(1.000100) can0 12#",
         ":2:17: expected an identifier of 3 or 8 hexadecimal digits and #, found \"12#\""},
        {"(1.0001", ":2:4: expected 6 or 9 decimals and a closing parenthesis, found \"0001\""},
        {"(1.000100)",
         ":2:11: expected the name of an interface, at most 15 characters, found the end of the line"},
    };
    for (const auto& [line, message] : cases) {
        CAPTURE(line);
        const TemporaryDirectory directory;
        const auto path =
            directory.write("run.log", "(1.000000) can0 001#\n" + line + "\n(1.000200) can0 003#\n");
        CandumpLog log(path);
        CHECK(ids_of(log) == Ids{1});
        CHECK(ids_of(log).empty());
        CHECK_THROWS_MATCHES(log.check(), InputError, Catch::Matchers::Message(path.string() + message));
    }
}

TEST_CASE("an incomplete last line loses only that line wherever it was cut off") {
    const std::string last = "(1.000200) can0 003#0102030405060708";
    for (std::size_t length = 1; length <= last.size(); ++length) {
        CAPTURE(length);
        const TemporaryDirectory directory;
        const auto path = directory.write("run.log", "(1.000000) can0 001#\n(1.000100) can0 002#\n" +
                                                         last.substr(0, length));
        CandumpLog log(path);
        const Ids ids = ids_of(log);
        CHECK_NOTHROW(log.check());
        CHECK((ids == Ids{1, 2} || ids == Ids{1, 2, 3}));
        if (ids.size() == 2) {
            CHECK_THAT(log.torn_line(), Catch::Matchers::StartsWith(path.string() + ":3:") &&
                                            Catch::Matchers::EndsWith("is torn and left out"));
        }
        CHECK(log.torn_line().empty() == (ids.size() == 3));
        CHECK((length < last.size() || ids.size() == 3)); // only the line end is missing
    }
}

TEST_CASE("a log that cannot be opened or read is rejected") {
    const TemporaryDirectory directory;
    const std::string path = directory.path().string();
    CHECK_THROWS_AS(CandumpLog(path + "/none"), InputError);
    CandumpLog folder(path);
    CHECK(ids_of(folder).empty());
    CHECK_THROWS_MATCHES(folder.check(), InputError,
                         Catch::Matchers::Message(path + ": cannot read: Is a directory"));
}
