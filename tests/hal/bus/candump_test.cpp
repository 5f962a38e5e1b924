// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/candump.hpp"

#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random_frame.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/seed.hpp"

#include <string>
#include <vector>

namespace {

using dfdyn::hal::CandumpFault;
using dfdyn::hal::CandumpLine;
using dfdyn::hal::CandumpText;
using dfdyn::hal::Frame;
using dfdyn::hal::Origin;
using dfdyn::hal::parse_candump_line;
using dfdyn::hal::StampDecimals;
using dfdyn::hal::write_candump_line;
using dfdyn::tests::same;

std::string written(const Frame& frame, StampDecimals decimals, std::string_view interface = "can0") {
    CandumpText text{};
    return std::string(write_candump_line(frame, interface, decimals, text));
}

Frame frame_of(std::uint32_t id, const std::vector<std::uint8_t>& data) {
    Frame frame;
    frame.stamp_ns = 1'700'000'000'123'456'000;
    frame.stamp_source = dfdyn::hal::StampSource::log;
    frame.id = id;
    frame.length = static_cast<std::uint8_t>(data.size());
    std::ranges::copy(data, frame.data.begin());
    return frame;
}

const std::string head = "(1700000000.123456) can0 ";

} // namespace

TEST_CASE("candump lines of every kind are parsed") {
    Frame extended = frame_of(0x1abcdef, {});
    extended.extended = true;
    Frame remote = frame_of(0x123, {});
    remote.remote = true;
    Frame remote_with_length = remote;
    remote_with_length.length = 4;
    Frame remote_of_8 = remote;
    remote_of_8.length = 8;
    Frame fd = frame_of(0x123, {0x11, 0x22});
    fd.fd = true;
    Frame fd_with_flags = fd;
    fd_with_flags.bit_rate_switch = true;
    fd_with_flags.error_state_indicator = true;
    Frame bus_off = frame_of(0x40, {0, 0, 0, 0, 0, 0, 0, 0});
    bus_off.error = true;
    Frame bus_off_without_data = frame_of(0x40, {});
    bus_off_without_data.error = true;
    Frame local = frame_of(0x123, {0xde, 0xad});
    local.origin = Origin::this_host;
    const Frame eight = frame_of(0x123, {0, 0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77});
    const std::pair<std::string, Frame> cases[] = {
        {"000#", frame_of(0, {})},
        {"7FF#DEADBEEF", frame_of(0x7ff, {0xde, 0xad, 0xbe, 0xef})},
        {"7ff#de.ad.be.ef", frame_of(0x7ff, {0xde, 0xad, 0xbe, 0xef})},
        {"01ABCDEF#", extended},
        {"123#0011223344556677", eight},
        {"123#0011223344556677_9", eight},
        {"123#0011223344556677_F R", eight},
        {"123#R", remote},
        {"123#R4", remote_with_length},
        {"123#R8_c", remote_of_8},
        {"123##01122", fd},
        {"123##41122", fd},
        {"123##31122", fd_with_flags},
        {"123##711.22", fd_with_flags},
        {"20000040#0000000000000000", bus_off},
        {"20000040#", bus_off_without_data},
        {"123#DEAD T", local},
        {"123#DEAD  T  \r", local},
        {"123#DEAD R", frame_of(0x123, {0xde, 0xad})},
    };
    for (const auto& [text, frame] : cases) {
        CAPTURE(text);
        const std::string line = head + text;
        const CandumpLine read = parse_candump_line(line);
        REQUIRE(read.kind == CandumpLine::Kind::frame);
        CHECK(read.interface == "can0");
        CHECK(same(read.frame, frame));
    }
}

TEST_CASE("candump time stamps have 6 or 9 decimals and any second that fits in nanoseconds") {
    const std::pair<std::string, std::int64_t> cases[] = {
        {"(0000000000.000000)", 0},
        {"(0.000001)", 1'000},
        {"(1.000000001)", 1'000'000'001},
        {"(1700000000.123456789)", 1'700'000'000'123'456'789},
        {"(9223372035.999999999)", 9'223'372'035'999'999'999},
    };
    for (const auto& [text, stamp_ns] : cases) {
        CAPTURE(text);
        const std::string line = text + " can0 123#";
        REQUIRE(parse_candump_line(line).kind == CandumpLine::Kind::frame);
        CHECK(parse_candump_line(line).frame.stamp_ns == stamp_ns);
    }
}

TEST_CASE("candump lines without a frame are classified") {
    for (const std::string line : {"", " ", "\t\r", "# (1.000000) can0 123#", "  #"}) {
        CAPTURE(line);
        CHECK(parse_candump_line(line).kind == CandumpLine::Kind::nothing);
    }
    const std::pair<std::string, std::uint64_t> notes[] = {
        {"DROPCOUNT: dropped 3 CAN frames on 'can0' socket (total drops 7)", 3},
        {"DROPCOUNT: dropped 1 CAN frame on 'can0' socket (total drops 4294967295)", 1},
    };
    for (const auto& [line, dropped] : notes) {
        const CandumpLine read = parse_candump_line(line);
        REQUIRE(read.kind == CandumpLine::Kind::dropped);
        CHECK(read.dropped == dropped);
        CHECK(read.interface == "can0");
    }
}

TEST_CASE("a malformed candump line is rejected with column and expected text and found text") {
    struct Case {
        std::string line;
        CandumpFault fault;
        std::size_t column;
        std::string found;
    };
    const Case cases[] = {
        {"can0 123#", CandumpFault::line_start, 1, "can0"},
        {"1.000000) can0 123#", CandumpFault::line_start, 1, "1.000000)"},
        {"(.000000) can0 123#", CandumpFault::stamp_seconds, 2, ".000000)"},
        {"(-1.000000) can0 123#", CandumpFault::stamp_seconds, 2, "-1.000000)"},
        {"(9223372036.000000) can0 123#", CandumpFault::stamp_seconds, 2, "9223372036.000000)"},
        {"(99999999999999999999.000000) can0 123#", CandumpFault::stamp_seconds, 2,
         "99999999999999999999.000000)"},
        {"(1,000000) can0 123#", CandumpFault::stamp_seconds, 2, "1,000000)"},
        {"(1.00000) can0 123#", CandumpFault::stamp_decimals, 4, "00000)"},
        {"(1.0000000) can0 123#", CandumpFault::stamp_decimals, 4, "0000000)"},
        {"(1.0000000000) can0 123#", CandumpFault::stamp_decimals, 4, "0000000000)"},
        {"(1.000000 can0 123#", CandumpFault::stamp_decimals, 4, "000000"},
        {"(1.000000)", CandumpFault::interface_name, 11, ""},
        {"(1.000000) a_name_of_16_letters 123#", CandumpFault::interface_name, 12, "a_name_of_16_letters"},
        {head, CandumpFault::identifier, 25, ""},
        {head + "12#", CandumpFault::identifier, 26, "12#"},
        {head + "1234#", CandumpFault::identifier, 26, "1234#"},
        {head + "123456789#", CandumpFault::identifier, 26, "123456789#"},
        {head + "12G#", CandumpFault::identifier, 26, "12G#"},
        {head + "123", CandumpFault::identifier, 26, "123"},
        {head + "123 #11", CandumpFault::identifier, 26, "123"},
        {head + "800#", CandumpFault::identifier_range, 26, "800#"},
        {head + "40000000#", CandumpFault::identifier_range, 26, "40000000#"},
        {head + "80000123#", CandumpFault::identifier_range, 26, "80000123#"},
        {head + "123#81:00:12345678#11", CandumpFault::can_xl, 26, "123#81:00:12345678#11"},
        {head + "45123#81:00:12345678#11", CandumpFault::can_xl, 26, "45123#81:00:12345678#11"},
        {head + "123##", CandumpFault::fd_flags, 31, ""},
        {head + "123##811", CandumpFault::fd_flags, 31, "811"},
        {head + "123##G11", CandumpFault::fd_flags, 31, "G11"},
        {head + "123#1", CandumpFault::data_byte, 30, "1"},
        {head + "123#11 2", CandumpFault::line_end, 33, "2"},
        {head + "123#1G", CandumpFault::data_byte, 30, "1G"},
        {head + "123#.11", CandumpFault::data_byte, 30, ".11"},
        {head + "123#11..22", CandumpFault::data_byte, 33, ".22"},
        {head + "123#11.", CandumpFault::data_byte, 33, ""},
        {head + "123#001122334455667788", CandumpFault::data_length, 46, "88"},
        {head + "123##0" + std::string(130, '0'), CandumpFault::data_length, 160, "00"},
        {head + "123##0001122334455667788", CandumpFault::fd_length, 32, "001122334455667788"},
        {head + "123#R9", CandumpFault::remote_length, 31, "9"},
        {head + "123#Rx", CandumpFault::remote_length, 31, "x"},
        {head + "123#R11", CandumpFault::line_end, 32, "1"},
        {head + "123#1122_9", CandumpFault::raw_length_code, 34, "_9"},
        {head + "123#0011223344556677_8", CandumpFault::raw_length_code, 46, "_8"},
        {head + "123#0011223344556677_", CandumpFault::raw_length_code, 46, "_"},
        {head + "123#0011223344556677_9x", CandumpFault::line_end, 48, "x"},
        {head + "123##000_9", CandumpFault::line_end, 34, "_9"},
        {head + "20000040##0", CandumpFault::error_frame, 35, "#0"},
        {head + "20000040#R", CandumpFault::error_frame, 35, "R"},
        {head + "123#11 X", CandumpFault::line_end, 33, "X"},
        {head + "123#11 TR", CandumpFault::line_end, 33, "TR"},
        {head + "123#11 T R", CandumpFault::line_end, 35, "R"},
        {head + "123#RT", CandumpFault::remote_length, 31, "T"},
        {"DROPCOUNT: dropped x CAN frames on 'can0' socket (total drops 7)", CandumpFault::drop_note, 20,
         "x"},
        {"DROPCOUNT: dropped 1 CAN frames on 'can0' socket (total drops 7) ?", CandumpFault::drop_note, 66,
         "?"},
        {"DROPCOUNT: dropped 1 CAN frames", CandumpFault::drop_note, 32, ""},
        {"DROP", CandumpFault::drop_note, 1, "DROP"},
    };
    for (const Case& expected : cases) {
        CAPTURE(expected.line);
        const CandumpLine read = parse_candump_line(expected.line);
        CHECK(read.kind == CandumpLine::Kind::malformed);
        CHECK(read.fault == expected.fault);
        CHECK(read.column == expected.column);
        CHECK(read.found == expected.found);
        CHECK_FALSE(dfdyn::hal::expected(read.fault).empty());
    }
}

TEST_CASE("lines are written in the format of candump") {
    CHECK(written(frame_of(0x12, {0xde, 0xad}), StampDecimals::microseconds) == head + "012#DEAD");
    CHECK(written(frame_of(0x12, {}), StampDecimals::nanoseconds) == "(1700000000.123456000) can0 012#");
    Frame frame = frame_of(0x12, {1});
    frame.stamp_ns = 1'999'999'999;
    frame.extended = true;
    frame.origin = Origin::this_socket;
    CHECK(written(frame, StampDecimals::microseconds) == "(0000000001.999999) can0 00000012#01 T");
}

TEST_CASE("a frame that no candump log can represent is not written") {
    Frame early = frame_of(0x12, {});
    early.stamp_ns = -1;
    Frame late = frame_of(0x12, {});
    late.stamp_ns = 9'223'372'036'000'000'000;
    Frame long_frame = frame_of(0x12, {});
    long_frame.length = 9;
    for (const Frame& frame : {early, late, long_frame, frame_of(0x800, {})}) {
        CHECK(written(frame, StampDecimals::nanoseconds).empty());
    }
    for (const std::string name : {"", "a_name_of_16_lett", "a b", "a\n"}) {
        CHECK(written(frame_of(0x12, {}), StampDecimals::nanoseconds, name).empty());
    }
}

TEST_CASE("random frames are unchanged after writing and reading a candump log without the heap") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int round = 0; round < 20'000; ++round) {
        const Frame frame = dfdyn::tests::random_frame(engine);
        CandumpText text{};
        const dfdyn::tests::AllocationGuard guard;
        const std::string_view line = write_candump_line(frame, "can0", StampDecimals::nanoseconds, text);
        const CandumpLine read = parse_candump_line(line);
        const auto calls = guard.calls();
        if (read.kind != CandumpLine::Kind::frame || !same(read.frame, frame) || calls.allocations != 0) {
            FAIL("round " << round << ": " << line);
        }
    }
}

TEST_CASE("candump lines with random byte errors are parsed or rejected without reading beyond their end") {
    DFDYN_SEEDED_ENGINE(engine);
    std::uniform_int_distribution<int> byte(0, 255);
    int refused = 0;
    for (int round = 0; round < 20'000; ++round) {
        std::string line = written(dfdyn::tests::random_frame(engine), StampDecimals::nanoseconds);
        line.resize(std::uniform_int_distribution<std::size_t>(0, line.size())(engine));
        for (int change = 0; change < 3 && !line.empty(); ++change) {
            line.at(std::uniform_int_distribution<std::size_t>(0, line.size() - 1)(engine)) =
                static_cast<char>(byte(engine));
        }
        // the address sanitizer detects reads beyond its end
        const std::vector<char> exact(line.begin(), line.end());
        const CandumpLine read = parse_candump_line({exact.data(), exact.size()});
        if (read.kind == CandumpLine::Kind::malformed) {
            ++refused;
            REQUIRE(read.column >= 1);
            REQUIRE(read.column <= line.size() + 1);
        } else if (read.kind == CandumpLine::Kind::frame) {
            REQUIRE(dfdyn::hal::is_well_formed(read.frame));
        }
    }
    CHECK(refused > 10'000);
}
