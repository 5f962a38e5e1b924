// SPDX-License-Identifier: Apache-2.0
#include "tests/support/catch.hpp"
#include "tests/tools/can/bus_support.hpp"
#include "tests/vcan/lateness.hpp"
#include "tests/vcan/peer.hpp"
#include "tools/replay/replay_interface.hpp"

#include <algorithm>
#include <bit>
#include <chrono>
#include <thread>

namespace {

using namespace dfdyn::tools;
using dfdyn::tests::IcubLog;

bool same_bits(const std::vector<float>& one, const std::vector<float>& other, std::size_t count) {
    return std::equal(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(count), other.begin(),
                      [](float a, float b) { return std::bit_cast<int>(a) == std::bit_cast<int>(b); });
}

/// Predictions while `dfdyn play` sent the log, and predictions from the recording of its frames.
struct LiveAndReplayed {
    ReplayedRecording live;
    ReplayedBus again;

    [[nodiscard]] long learned() const {
        return std::ranges::count_if(live.status, [](const auto& status) { return status.learned(); });
    }
};

LiveAndReplayed live_and_replayed(const IcubLog& log) {
    const auto recorded = log.directory.path() / "recorded.log";
    std::atomic<bool> stop = false;
    const long receivers = dfdyn::tests::receivers();
    std::thread player([&] {
        dfdyn::tests::wait_for_receivers(receivers);
        dfdyn::tests::run(std::string(DFDYN_PROGRAM) + " play --log " + log.path.string() + " --can vcan0");
        std::this_thread::sleep_for(std::chrono::milliseconds(200)); // the last frames are delivered
        stop = true;
    });
    const auto live_estimator = make_estimator(log.model, true);
    ReplayedRecording live =
        replay_interface(*live_estimator, {&log.model, 1}, log.bus, {"vcan0", 0, recorded}, 0, stop).replayed;
    player.join();
    const auto estimator = make_estimator(log.model, true);
    return {std::move(live), replay_log(*estimator, {&log.model, 1}, log.bus, recorded, "", 0)};
}

} // namespace

TEST_CASE("predictions on a live bus are bit-identical to those from its recording", "[virtual_time]") {
    // Real time uses 100 Hz, because a booted kernel gave too few valid ticks at 1 kHz.
    const int rate_hz = dfdyn::tests::virtual_time() ? 1000 : 100;
    const int rows = 2 * rate_hz;
    const IcubLog log(rows, rate_hz);
    const std::uint64_t frames = 4 * static_cast<std::uint64_t>(rows) + 6; // with the sensor's full scales
    // Positions half a period late leave a tick without any. The encoder then has to qualify again.
    const std::chrono::milliseconds loses_a_tick{1500 / rate_hz};
    constexpr int before_learning = 9 + 4; // readings until an encoder qualifies, plus the lags
    LiveAndReplayed both;
    const bool right = dfdyn::tests::right_unless_stalled(
        [&] {
            both = live_and_replayed(log);
            return both.again.bus.frames == frames &&
                   both.again.replayed.status.size() > static_cast<std::size_t>(rows * 3 / 4) &&
                   (dfdyn::tests::virtual_time() ? both.learned() == rows - before_learning
                                                 : both.learned() > rows / 2);
        },
        loses_a_tick);
    CAPTURE(both.again.bus.frames, both.learned());
    CHECK(right);
    const auto& [live, again] = both;
    const ReplayedRecording& replayed = again.replayed;
    const std::size_t ticks = replayed.status.size();
    REQUIRE(live.status.size() >= ticks); // the recording lacks the silence after the last frame
    CHECK(std::equal(replayed.time_s.begin(), replayed.time_s.end(), live.time_s.begin()));
    CHECK(std::equal(replayed.bus_reason.begin(), replayed.bus_reason.end(), live.bus_reason.begin()));
    CHECK(same_bits(replayed.predicted, live.predicted, 6 * ticks));
    CHECK(same_bits(replayed.standard_deviation, live.standard_deviation, 6 * ticks));
}
