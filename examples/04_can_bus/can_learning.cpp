// SPDX-License-Identifier: Apache-2.0
// Learning on a microcontroller: a periodic timer interrupt reads the received CAN frames, assembles and
// checks a sample, predicts, and learns within its budget. The idle loop saves the learned state, and the
// next start continues with it. In this example the frames come from memory; for a board with a CAN
// controller, replace `Mailbox`.
#include "report.hpp"
#include "stack_watermark.hpp"
#include "systick.hpp"
#include "ur5_frames.hpp" // 2.4 s of six CiA 402 drives
#include "ur5_model.hpp"

#include "dfdyn/hal/assembly/effort_output.hpp"
#include "dfdyn/hal/device/cia402.hpp"
#include "dfdyn/hal/sample_assembly.hpp"

#include <algorithm>
#include <numbers>

namespace {

namespace hal = dfdyn::hal;

constexpr int joints = 6;
constexpr std::int64_t sample_period_ns = 8'000'000; // of the recording; the timer is eight times faster
constexpr std::uint32_t timer_hz = 1000;

/// Replaces the CAN controller. Its clock is the timer.
class Mailbox {
  public:
    void advance() noexcept { now_ns_ += sample_period_ns; }
    [[nodiscard]] bool ended() const noexcept { return next_ == std::size(ur5_frames); }

    std::span<const hal::Frame> drain(std::span<hal::Frame> into) noexcept {
        std::size_t count = 0;
        for (; count < into.size() && !ended() && stamp_ns(ur5_frames[next_]) <= now_ns_; ++next_) {
            const Ur5Frame& received = ur5_frames[next_];
            hal::Frame& frame = into[count++] = hal::Frame{};
            frame.stamp_ns = stamp_ns(received);
            frame.stamp_source = hal::StampSource::hardware;
            frame.id = received.id;
            frame.length = received.length;
            std::copy_n(received.data, received.length, frame.data.begin());
        }
        counters_.received += count;
        return into.first(count);
    }
    hal::SendResult send(const hal::Frame& /*frame*/) noexcept { return hal::SendResult::sent; }
    [[nodiscard]] std::int64_t now_ns() const noexcept { return now_ns_; }
    [[nodiscard]] hal::BusState state() const noexcept { return hal::BusState::active; }
    [[nodiscard]] const hal::BusCounters& counters() const noexcept { return counters_; }

  private:
    static constexpr std::int64_t stamp_ns(const Ur5Frame& frame) {
        return std::int64_t{1000} * frame.time_us;
    }

    std::int64_t now_ns_ = stamp_ns(ur5_frames[0]);
    std::size_t next_ = 0;
    hal::BusCounters counters_;
};
static_assert(hal::Bus<Mailbox>);

using Currents = hal::EffortOutput<joints, 4>;
using Assembly = hal::SampleAssembly<float, joints, hal::Cia402Drive, joints, Currents, 4>;
using Estimator = dfdyn::Estimator<ur5_model::Model>;

constexpr hal::TrackConfig track{.max_age_ns = 3 * sample_period_ns, .latency_ns = 0, .qualification = {}};

constexpr hal::Cia402Drive drive(int joint) {
    const hal::Signal position{.start_bit = 0,
                               .length = 32,
                               .encoding = hal::Encoding::signed_integer,
                               .factor = 2 * std::numbers::pi / 1048576};
    const hal::Signal current{
        .start_bit = 32, .length = 16, .encoding = hal::Encoding::signed_integer, .factor = 0.001};
    return hal::Cia402Drive({.node = joint + 1,
                             .joint = joint,
                             .position_pdo = 0x280,
                             .position_length = 6,
                             .position = position,
                             .effort_pdo = 0x280,
                             .effort_length = 6,
                             .effort = current});
}

template <class T>
constexpr std::array<T, joints> six(const T& value) {
    return {value, value, value, value, value, value};
}

Mailbox mailbox;
Assembly assembly({.board = {drive(0), drive(1), drive(2), drive(3), drive(4), drive(5)},
                   .position = track,
                   .position_range = six(hal::Range{-7, 7}),
                   .clock = {.tolerance_ns = 2 * sample_period_ns}},
                  Currents({.track = track, .range = six(hal::Range{-20, 20})}));
Estimator estimator(ur5_model::constants);
/// Multiply-adds of learning per tick: a sample is learned in two or three ticks.
constexpr dfdyn::Budget budget{Estimator::cost().learn / 2};
static_assert(budget.affords(Estimator::cost().largest_step), "a smaller budget may never finish a sample");

struct Statistics {
    std::uint32_t interrupts = 0;
    /// Interrupts that were due before the previous one had ended.
    std::uint32_t overruns = 0;
    /// Longest interrupt, in timer counts.
    std::uint32_t longest = 0;
    float error_square = 0; ///< of joint 2
    float output_square = 0;
    std::uint32_t saved = 0;   ///< number of snapshots
    std::uint32_t refused = 0; ///< snapshots refused because the state changed
};
Statistics statistics;
constexpr std::uint32_t interrupts_before_save = 150;
volatile bool ended;

constexpr std::uint32_t erased = 0xFFFF'FFFF; ///< as flash memory reads after an erasure

/// A place for a snapshot in flash memory. Its number is erased first and written last, so that a place with
/// a number has a whole snapshot, also after a power failure.
struct Place {
    std::array<std::byte, Estimator::snapshot_capacity> snapshot; ///< pages are appended
    std::uint32_t number = erased;                                ///< of the save, from 0

    std::uint32_t saves() const { return number + 1; } ///< 0: there is no snapshot
};
std::array<Place, 2> flash; ///< written in turn: the last good snapshot is never overwritten

Place& older() { return flash[0].saves() <= flash[1].saves() ? flash[0] : flash[1]; }
Place& newer() { return flash[0].saves() <= flash[1].saves() ? flash[1] : flash[0]; }

void learn(std::int64_t instant_ns) {
    const auto [sample, report] = assembly.assemble(instant_ns, mailbox.now_ns());
    if (report.position != hal::Reason::ok) {
        return;
    }
    const auto estimate = estimator.tick(sample, budget);
    if (estimate.status.predicted() && sample.output_valid) { // for comparison; never feed it forward
        statistics.error_square += estimate.innovation[1] * estimate.innovation[1];
        statistics.output_square += sample.output[1] * sample.output[1];
    }
}

void end_of_interrupt() {
    const std::uint32_t spent = systick().reload - systick().value;
    statistics.overruns += (systick().control & SysTick::passed_zero) != 0 ? 1 : 0;
    statistics.longest = std::max(statistics.longest, spent);
    ++statistics.interrupts;
    ended = mailbox.ended();
}

/// Saves the learned state page by page, while the interrupt keeps ticking and predicting.
void save() {
    constexpr std::size_t page_bytes = 256;
    const std::uint32_t number = newer().saves();
    Place& place = older();
    place.number = erased;
    dfdyn::SnapshotWriter writer(estimator);
    while (writer.step(place.snapshot, page_bytes) == dfdyn::SnapshotResult::in_progress) {
        asm volatile("wfi" ::: "memory"); // other work of the idle loop goes here
    }
    const bool whole = writer.result() == dfdyn::SnapshotResult::ok;
    place.number = whole ? number : erased;
    (whole ? statistics.saved : statistics.refused) += 1;
}

/// Restores the newest good snapshot: a damaged one is refused whole, and the one before it is used. The
/// damaged one's place is then written next. Call it before the first tick. Returns false if there is none,
/// as at the very first start.
bool restore() {
    for (Place* const place : {&newer(), &older()}) {
        if (place->number != erased && estimator.restore(place->snapshot) == dfdyn::SnapshotResult::ok) {
            return true;
        }
        place->number = erased;
    }
    return false;
}

/// Returns whether the next start finds what was learned, also if the newest snapshot is damaged.
bool survives_restart() {
    save(); // before the power is switched off
    Place& newest = newer();
    estimator.reset();
    const bool restored = statistics.refused == 0 && restore() && newest.number != erased;
    newest.snapshot[100] ^= std::byte{1};
    estimator.reset();
    return restored && restore() && newest.number == erased;
}

bool learned_well() {
    const dfdyn::Counters& counters = estimator.counters();
    report(DFDYN_CORE ": CAN learning: interrupts ", statistics.interrupts, "");
    report(", frames ", static_cast<std::uint32_t>(mailbox.counters().received), "");
    report(", samples ", static_cast<std::uint32_t>(counters.ticks), "");
    report(", predicted ", static_cast<std::uint32_t>(counters.predicted), "");
    report(", learned ", static_cast<std::uint32_t>(counters.learned), "");
    report(", overruns ", statistics.overruns, "");
    report(", snapshots saved meanwhile ", statistics.saved, "");
    report("; an interrupt took at most ", statistics.longest / (core_clock_hz / 1'000'000),
           " us of 1000, at 500 million instructions per second");
    report("; stack ", stack_used_bytes(), " bytes\n");
    return counters.ticks >= 285 && counters.predicted >= 275 && counters.learned > 50 &&
           statistics.overruns == 0 && statistics.saved > 0 && survives_restart() &&
           statistics.error_square < 0.05F * statistics.output_square;
}

} // namespace

extern "C" void systick_handler() {
    static std::array<hal::Frame, 16> room;
    if (ended) {
        return;
    }
    static_cast<void>(systick().control); // clears the flag that the timer passed zero
    mailbox.advance();
    assembly.drain(mailbox, room, [](const hal::SampleTrigger& moment) { learn(moment.instant_ns); });
    end_of_interrupt();
}

int application() {
    static_cast<void>(restore()); // what was learned before the last power-off
    start_systick(core_clock_hz / timer_hz - 1, SysTick::interrupts);
    while (!ended) {
        asm volatile("wfi" ::: "memory");
        if (statistics.saved == 0 && statistics.interrupts >= interrupts_before_save) {
            save();
        }
    }
    return learned_well() ? 0 : 1;
}
