// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/bus_event.hpp"

#include "tests/support/catch.hpp"

#include <string>
#include <vector>

namespace {

using dfdyn::hal::BusCounters;
using dfdyn::hal::BusState;
using dfdyn::hal::Frame;
using dfdyn::hal::note_frame;

struct Bytes {
    std::uint8_t controller = 0;      ///< data[1]
    std::uint8_t transmit_errors = 0; ///< data[6]
    std::uint8_t receive_errors = 0;  ///< data[7]
};

Frame error_frame(std::uint32_t classes, Bytes bytes = {}) {
    Frame frame;
    frame.error = true;
    frame.id = classes;
    frame.length = 8;
    frame.data[1] = bytes.controller;
    frame.data[6] = bytes.transmit_errors;
    frame.data[7] = bytes.receive_errors;
    return frame;
}

BusState state_after(BusState before, const std::vector<Frame>& frames) {
    BusCounters counters;
    for (const Frame& frame : frames) {
        note_frame(frame, before, counters);
    }
    return before;
}

/// Nonzero counters as text, each with its name and value.
std::string counted(const BusCounters& counters) {
    const std::pair<const char*, std::uint64_t> all[] = {
        {"received", counters.received},
        {"dropped", counters.dropped},
        {"overruns", counters.controller_overruns},
        {"arbitration", counters.lost_arbitrations},
        {"unacknowledged", counters.no_acknowledgements},
        {"bus_errors", counters.bus_errors},
        {"transmit", counters.transmit_faults},
        {"errors", counters.error_frames},
        {"off", counters.bus_off},
        {"restarted", counters.restarted},
        {"down", counters.interface_down},
    };
    std::string text;
    for (const auto& [name, value] : all) {
        if (value > 0) {
            text.append(name).append(" ").append(std::to_string(value)).append(" ");
        }
    }
    return text;
}

} // namespace

TEST_CASE(
    "each class of error frame increments its own counters and changes the state only if it reports one") {
    struct Case {
        std::uint32_t classes;
        Bytes bytes;
        BusState state;
        std::string counters;
    };
    const Case cases[] = {
        {0x001, {}, BusState::active, "transmit 1 errors 1 "},
        {0x002, {}, BusState::active, "arbitration 1 errors 1 "},
        {0x004, {.controller = 0x00}, BusState::active, "errors 1 "},
        {0x004, {.controller = 0x01}, BusState::active, "overruns 1 errors 1 "},
        {0x004, {.controller = 0x02}, BusState::active, "transmit 1 errors 1 "},
        {0x004, {.controller = 0x04}, BusState::warning, "errors 1 "},
        {0x004, {.controller = 0x08}, BusState::warning, "errors 1 "},
        {0x004, {.controller = 0x10}, BusState::passive, "errors 1 "},
        {0x004, {.controller = 0x20}, BusState::passive, "errors 1 "},
        {0x004, {.controller = 0x28}, BusState::passive, "errors 1 "},
        {0x004, {.controller = 0x05}, BusState::warning, "overruns 1 errors 1 "},
        {0x008, {}, BusState::active, "bus_errors 1 errors 1 "},
        {0x010, {}, BusState::active, "bus_errors 1 errors 1 "},
        {0x020, {}, BusState::active, "unacknowledged 1 errors 1 "},
        {0x040, {}, BusState::off, "errors 1 off 1 "},
        {0x080, {}, BusState::active, "bus_errors 1 errors 1 "},
        {0x088, {}, BusState::active, "bus_errors 1 errors 1 "},
        {0x100, {}, BusState::active, "errors 1 restarted 1 "},
        {0x200, {.transmit_errors = 95}, BusState::active, "errors 1 "},
        {0x200, {.transmit_errors = 96}, BusState::warning, "errors 1 "},
        {0x200, {.receive_errors = 127}, BusState::warning, "errors 1 "},
        {0x200, {.receive_errors = 128}, BusState::passive, "errors 1 "},
        {0x204, {.controller = 0x08, .transmit_errors = 200}, BusState::warning, "errors 1 "},
        {0x400, {.controller = 0x31, .transmit_errors = 200}, BusState::active, "errors 1 "},
        {0x000, {.controller = 0x31}, BusState::active, "errors 1 "},
        // data bytes of a class whose bit is not set
        {0x002, {.controller = 0x31, .transmit_errors = 200}, BusState::active, "arbitration 1 errors 1 "},
        // several classes at once: bus-off has priority
        {0x0e4, {.controller = 0x20}, BusState::off, "unacknowledged 1 bus_errors 1 errors 1 off 1 "},
    };
    for (const Case& expected : cases) {
        CAPTURE(expected.classes, int(expected.bytes.controller));
        BusState state = BusState::active;
        BusCounters counters;
        note_frame(error_frame(expected.classes, expected.bytes), state, counters);
        CHECK(state == expected.state);
        CHECK(counted(counters) == expected.counters);
    }
}

TEST_CASE("a controller recovers from every error level and from a reported restart after bus-off") {
    const Frame active = error_frame(0x004, {.controller = 0x40});
    const Frame warning = error_frame(0x004, {.controller = 0x08});
    const Frame passive = error_frame(0x004, {.controller = 0x20});
    const Frame off = error_frame(0x040);
    const Frame restarted = error_frame(0x100);
    const Frame quiet_counters = error_frame(0x200);
    CHECK(state_after(BusState::warning, {active}) == BusState::active);
    CHECK(state_after(BusState::passive, {warning}) == BusState::warning);
    CHECK(state_after(BusState::passive, {quiet_counters}) == BusState::active);
    CHECK(state_after(BusState::active, {passive, off, quiet_counters}) == BusState::off);
    CHECK(state_after(BusState::active, {off, error_frame(0x002), error_frame(0x0a0)}) == BusState::off);
    CHECK(state_after(BusState::active, {off, restarted}) == BusState::active);
    CHECK(state_after(BusState::off, {active}) == BusState::active);
    CHECK(state_after(BusState::interface_down, {active, off, restarted}) == BusState::interface_down);
}

TEST_CASE("a repeated report of bus-off is counted once") {
    BusState state = BusState::active;
    BusCounters counters;
    for (const std::uint32_t classes : {0x040U, 0x040U, 0x100U, 0x040U}) {
        note_frame(error_frame(classes), state, counters);
    }
    CHECK(state == BusState::off);
    CHECK(counters.bus_off == 2);
    CHECK(counters.restarted == 1);
    CHECK(counters.error_frames == 4);
}

TEST_CASE("a frame received from another node ends bus-off but a frame of this computer does not") {
    Frame data;
    data.id = 0x281;
    CHECK(state_after(BusState::off, {data}) == BusState::active);
    CHECK(state_after(BusState::active, {error_frame(0x040), data, error_frame(0x040)}) == BusState::off);
    CHECK(state_after(BusState::interface_down, {data}) == BusState::interface_down);
    for (const auto own : {dfdyn::hal::Origin::this_socket, dfdyn::hal::Origin::this_host}) {
        data.origin = own;
        CHECK(state_after(BusState::off, {data}) == BusState::off);
    }
}

TEST_CASE("the identifier of a data frame is never evaluated as error classes") {
    Frame frame = error_frame(0x040, {.controller = 0xff});
    frame.error = false;
    BusState state = BusState::warning;
    BusCounters counters;
    note_frame(frame, state, counters);
    CHECK(state == BusState::warning);
    CHECK(counted(counters).empty());
}
