// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/clock/clock.hpp"
#include "dfdyn/hal/replay_bus.hpp"

#include "tests/support/allocation_guard.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/random_frame.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/seed.hpp"

#include <array>
#include <vector>

namespace {

using dfdyn::hal::BusState;
using dfdyn::hal::Frame;
using dfdyn::hal::Origin;
using dfdyn::hal::ReplayBus;
using dfdyn::hal::ReplayEntry;
using dfdyn::hal::SendResult;
using dfdyn::tests::same;

/// A recording in memory.
class Entries {
  public:
    explicit Entries(std::vector<ReplayEntry> entries, std::uint64_t dropped_at_end = 0)
        : entries_(std::move(entries)), dropped_at_end_(dropped_at_end) {}

    bool next(ReplayEntry& entry) noexcept {
        if (at_ == entries_.size()) {
            entry.dropped_before = std::exchange(dropped_at_end_, 0);
            return false;
        }
        entry = entries_[at_];
        ++at_;
        return true;
    }

  private:
    std::vector<ReplayEntry> entries_;
    std::uint64_t dropped_at_end_;
    std::size_t at_ = 0;
};
static_assert(dfdyn::hal::Bus<ReplayBus<Entries>>);

ReplayEntry entry(std::int64_t stamp_ns, std::uint32_t id, std::uint64_t dropped_before = 0) {
    ReplayEntry out;
    out.frame.stamp_ns = stamp_ns;
    out.frame.id = id;
    out.dropped_before = dropped_before;
    return out;
}

template <class AnyBus>
std::vector<std::uint32_t> drained_ids(AnyBus& bus, std::size_t room = 16) {
    std::vector<Frame> frames(room);
    std::vector<std::uint32_t> ids;
    for (const Frame& frame : bus.drain(frames)) {
        ids.push_back(frame.id);
    }
    return ids;
}

using Ids = std::vector<std::uint32_t>;

} // namespace

TEST_CASE("a replay returns a frame once its clock has reached the frame's time stamp") {
    Entries entries({entry(1000, 1), entry(1000, 2), entry(2000, 3), entry(5000, 4)});
    ReplayBus bus(entries);
    CHECK(bus.now_ns() == 1000);
    CHECK(drained_ids(bus) == Ids{1, 2});
    CHECK(drained_ids(bus).empty());
    CHECK(bus.next_stamp_ns() == 2000);
    bus.advance_to(1999);
    CHECK(drained_ids(bus).empty());
    bus.advance_to(2000);
    CHECK(drained_ids(bus) == Ids{3});
    bus.advance_to(100);
    CHECK(bus.now_ns() == 2000);
    CHECK_FALSE(bus.ended());
    bus.advance_to(9000);
    CHECK(bus.next_stamp_ns() == 9000);
    CHECK(drained_ids(bus) == Ids{4});
    CHECK(bus.ended());
    CHECK(bus.next_stamp_ns() == 9000);
    CHECK(drained_ids(bus).empty());
    CHECK(bus.counters().received == 4);
    CHECK(bus.counters().saturated_drains == 0);
}

TEST_CASE("a replay without frames has ended") {
    Entries entries({}, 5);
    ReplayBus bus(entries);
    CHECK(bus.ended());
    CHECK(drained_ids(bus).empty());
    CHECK(bus.counters().dropped == 5);
}

TEST_CASE("a replay fills at most the given buffer and reports that frames are left") {
    Entries entries({entry(0, 1), entry(0, 2), entry(0, 3), entry(0, 4)});
    ReplayBus bus(entries);
    CHECK(drained_ids(bus, 3) == Ids{1, 2, 3});
    CHECK(bus.counters().saturated_drains == 1);
    CHECK(drained_ids(bus, 1) == Ids{4});
    CHECK(bus.counters().saturated_drains == 1);
}

TEST_CASE("a replay keeps order and time stamps that run backward but its clock never does") {
    Entries entries({entry(5000, 1), entry(2000, 2), entry(3000, 3), entry(6000, 4)});
    ReplayBus bus(entries);
    std::array<Frame, 8> room;
    const auto frames = bus.drain(room);
    REQUIRE(frames.size() == 3);
    CHECK(frames[1].stamp_ns == 2000);
    CHECK(frames[2].stamp_ns == 3000);
    CHECK(bus.now_ns() == 5000);
    CHECK(bus.next_stamp_ns() == 6000);
}

TEST_CASE("a replay counts lost frames when it returns the frame after the loss") {
    Entries entries({entry(1000, 1), entry(2000, 2, 7)}, 2);
    ReplayBus bus(entries);
    CHECK(drained_ids(bus) == Ids{1});
    CHECK(bus.counters().dropped == 0);
    bus.advance_to(2000);
    CHECK(drained_ids(bus) == Ids{2});
    CHECK(bus.counters().dropped == 9);
}

TEST_CASE("error frames of a recording change the state of the bus and disable sending") {
    ReplayEntry off = entry(2000, 0x40);
    off.frame.error = true;
    ReplayEntry restarted = entry(3000, 0x100);
    restarted.frame.error = true;
    Entries entries({entry(1000, 0x40), off, restarted});
    ReplayBus bus(entries);
    drained_ids(bus);
    CHECK(bus.state() == BusState::active);
    CHECK(bus.send(Frame{}) == SendResult::sent);
    bus.advance_to(2000);
    CHECK(drained_ids(bus) == Ids{0x40});
    CHECK(bus.state() == BusState::off);
    CHECK(bus.send(Frame{}) == SendResult::bus_closed);
    bus.advance_to(3000);
    drained_ids(bus);
    CHECK(bus.state() == BusState::active);
    CHECK(bus.counters().error_frames == 2);
    CHECK(bus.counters().sent == 1);
}

TEST_CASE("frames sent to a replay can be read in order and a full queue refuses further frames") {
    using AnyBus = ReplayBus<Entries>;
    Entries entries({entry(1000, 1)});
    AnyBus bus(entries);
    bus.advance_to(1500);
    Frame frame;
    for (std::uint32_t id = 0; id < AnyBus::sent_capacity; ++id) {
        frame.id = id;
        REQUIRE(bus.send(frame) == SendResult::sent);
    }
    CHECK(bus.send(frame) == SendResult::refused);
    CHECK(bus.counters().send_refused == 1);
    std::array<Frame, 40> room;
    const auto first = bus.take_sent(room);
    REQUIRE(first.size() == 40);
    CHECK(first[39].id == 39);
    CHECK(first[39].stamp_ns == 1500);
    CHECK(first[39].origin == Origin::this_socket);
    frame.id = 0x7ff;
    CHECK(bus.send(frame) == SendResult::sent);
    const auto second = bus.take_sent(room);
    REQUIRE(second.size() == 25);
    CHECK(second[0].id == 40);
    CHECK(second[24].id == 0x7ff);
    CHECK(bus.take_sent(room).empty());
    frame.id = 0x800;
    CHECK(bus.send(frame) == SendResult::invalid);
    CHECK(bus.counters().sent == 65);
}

TEST_CASE("a replay returns random recordings completely, without the heap, for any clock steps") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int round = 0; round < 50; ++round) {
        std::vector<ReplayEntry> recording(200);
        for (ReplayEntry& recorded : recording) {
            recorded.frame = dfdyn::tests::random_frame(engine);
            recorded.frame.stamp_ns %= 10'000;
        }
        Entries entries(recording);
        ReplayBus bus(entries);
        std::array<Frame, 7> room;
        std::size_t got = 0;
        std::size_t differing = 0;
        const dfdyn::tests::AllocationGuard guard;
        while (!bus.ended()) {
            const std::int64_t before_ns = bus.now_ns();
            bus.advance_to(bus.now_ns() + static_cast<std::int64_t>(engine() % 300));
            for (const Frame& frame : bus.drain(room)) {
                differing += same(frame, recording.at(got).frame) ? 0 : 1;
                ++got;
            }
            bus.send(Frame{});
            bus.take_sent(room);
            differing += bus.now_ns() < before_ns ? 1 : 0;
        }
        const auto calls = guard.calls();
        REQUIRE(calls.allocations == 0);
        REQUIRE(got == recording.size());
        REQUIRE(differing == 0);
    }
}

namespace {

constexpr std::int64_t ms = 1'000'000;

/// One frame per millisecond. The time stamps of frames `from` to `to` - 1 are wrong by `error_ns`.
std::vector<ReplayEntry> stepping_clock(int frames, int from, int to, std::int64_t error_ns) {
    std::vector<ReplayEntry> recording;
    for (int number = 0; number < frames; ++number) {
        const std::int64_t off_ns = number >= from && number < to ? error_ns : 0;
        recording.push_back(entry(100'000 * ms + number * ms + off_ns, static_cast<std::uint32_t>(number)));
    }
    return recording;
}

/// Result of a clock gate for a recording that is read every millisecond.
struct Gated {
    dfdyn::hal::ClockGate gate{{}};
    int good = 0; ///< frames that were accepted with a stamp less than 1 ms old
    std::int64_t took_ns = 0;

    explicit Gated(const std::vector<ReplayEntry>& recording) {
        Entries entries(recording);
        ReplayBus bus(entries);
        std::array<Frame, 64> room;
        const std::int64_t begin_ns = bus.now_ns();
        while (!bus.ended()) {
            for (const Frame& frame : bus.drain(room)) {
                const auto stamp_ns = gate.accept(frame.stamp_ns, bus.now_ns());
                good += stamp_ns && bus.now_ns() - *stamp_ns < ms ? 1 : 0;
            }
            took_ns = bus.now_ns() - begin_ns;
            bus.advance_to(bus.now_ns() + ms);
        }
    }
};

} // namespace

TEST_CASE("a recording continues after its clock was set back and the new clock is adopted once") {
    for (const std::int64_t jump_ns : {-6'000 * ms, -90'000 * ms, -50 * ms}) {
        const Gated gated(stepping_clock(10'000, 3'000, 10'000, jump_ns));
        CHECK(gated.gate.adopted() == 1);
        CHECK(gated.gate.refused() == 20);
        CHECK(gated.good == 10'000 - 19);
        CHECK(gated.took_ns == (10'000 - 2) * ms); // all but the step itself, whose length is unknown
    }
}

TEST_CASE("an outlier among the time stamps affects a recording's clock only while it lasts") {
    const Gated back(stepping_clock(5'000, 3'000, 3'001, -6'000 * ms));
    CHECK(back.gate.adopted() == 0);
    CHECK(back.good == 5'000 - 1);
    CHECK(back.took_ns == 4'999 * ms);
    const Gated ahead(stepping_clock(5'000, 3'000, 3'001, 6'000 * ms)); // looks like a silence
    CHECK(ahead.gate.adopted() == 1);
    CHECK(ahead.good == 5'000 - 19);
}

TEST_CASE(
    "frames that overtake each other repeatedly keep the recording's clock in step with its time stamps") {
    std::vector<ReplayEntry> recording;
    for (int number = 0; number < 5'000; ++number) {
        recording.push_back(entry(number * ms + 400'000, 1));
        recording.push_back(entry(number * ms + 100'000, 2));
    }
    const Gated gated(recording);
    CHECK(gated.good == 10'000);
    CHECK(gated.took_ns == 4'999 * ms);
}
