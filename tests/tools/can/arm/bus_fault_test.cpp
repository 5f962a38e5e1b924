// SPDX-License-Identifier: Apache-2.0
// Effect of faults on replay: it accepts no wrong value, and it rejects good values only for a limited time.
#include "dfdyn/hal/device/icub_strain.hpp"

#include "tests/tools/can/bus_check_support.hpp"
#include "tools/can/arm/bus_sampler.hpp"

#include <map>

namespace {

using namespace dfdyn::tests;
using dfdyn::hal::make_frame;
using dfdyn::tools::BusSample;
using dfdyn::tools::BusTraffic;

/// Values that `replay` accepted from the frames of `sound`.
struct Accepted {
    int samples = 0;
    int positions = 0, outputs = 0; ///< samples with positions, and with outputs
    int wrong = 0;                  ///< accepted values that are wrong
    std::map<std::string, int> refused;

    void take(const BusDescription& description, const BusSample& sample) {
        ++samples;
        positions += sample.valid() ? 1 : 0;
        outputs += sample.sample.output_valid ? 1 : 0;
        ++refused[dfdyn::hal::name(sample.valid() ? sample.report.output : sample.report.position)];
        const double t = 1e-9 * static_cast<double>(sample.sample.time_ns - BusTraffic::lead_ns);
        for (std::size_t i = 0; sample.valid() && i < sample.positions().size(); ++i) {
            const double truth = 0.4 + 0.2 * std::sin(t + static_cast<double>(i));
            wrong += std::abs(sample.positions()[i] - truth) > 5e-3 ? 1 : 0; // it moves 2 mrad in a period
        }
        for (std::size_t k = 0; k < sample.valid_outputs().size(); ++k) {
            const double truth = sound_output(description, t); // its noise is 0.1
            wrong += std::abs(sample.valid_outputs()[k] - truth) > 0.6 ? 1 : 0;
        }
    }
};

Accepted replayed(const BusDescription& description, const Frames& frames) {
    Accepted accepted;
    dfdyn::tools::BusSampler sampler(description,
                                     [&](const BusSample& sample) { accepted.take(description, sample); });
    Tape tape(frames);
    TapeBus bus(tape);
    std::array<Frame, 1> room{};
    while (!bus.ended()) {
        bus.advance_to(bus.next_stamp_ns());
        for (const Frame& frame : bus.drain(room)) {
            sampler.take(frame, bus.state(), bus.counters());
        }
    }
    CHECK(accepted.wrong == 0);
    return accepted;
}

/// The iCub's arm with full scales that only the sensor itself reports.
BusDescription icub_without_full_scales(const std::string& instead = "") {
    const std::string text = file_content(bus_folder + "icub_arm_strain.json");
    return described(text.substr(0, text.find(", \"full_scale\"")) + instead + "}}");
}

constexpr int few = 30; ///< samples until a source qualifies, plus the frames of the fault

} // namespace

TEST_CASE("drives that boot without sending heartbeats are accepted without an entry in the description") {
    Frames frames = without(sound(drives()), [](const Frame& frame) { return frame.id > 0x700; });
    const int good = replayed(drives(), frames).outputs;
    CHECK(good > 450);
    for (std::uint32_t node = 1; node <= 6; ++node) {
        Frame boot_up = make_frame(0x700 + node, 1);
        boot_up.stamp_ns = frames.front().stamp_ns - 1'000'000;
        frames.insert(frames.begin(), boot_up);
    }
    CHECK(replayed(drives(), frames).outputs >= good - 1);
    CHECK(replayed(drives(), with(frames, make_frame(0x703, 1))).outputs > good - few); // one restarts
}

TEST_CASE("ODrives with firmware 0.6 are accepted without an entry in the description") {
    const BusDescription arm = described(odrive_and_ati);
    const Frames good = sound(arm);
    const auto is_heartbeat = [](const Frame& frame) {
        return (frame.id & 0x1F) == 0x01 && frame.id < 0x100;
    };
    const Frames newer =
        changed(good, [&](Frame& frame) { frame.data[6] = is_heartbeat(frame) ? 1 : frame.data[6]; });
    CHECK(replayed(arm, newer).outputs > 0.9 * replayed(arm, good).outputs);
    const Frames failed = changed(newer, [&](Frame& frame) {
        frame.data[0] = is_heartbeat(frame) && frame.stamp_ns > 2'000'000'000 ? 8 : frame.data[0];
    });
    CHECK(replayed(arm, failed).refused["encoder_fault"] > 150);
}

TEST_CASE("an ODrive's estimate that is lost between two heartbeats is not accepted as the arm's position") {
    const BusDescription arm = described(odrive_and_ati);
    const Frames lost = changed(sound(arm), [](Frame& frame) {
        const bool between = frame.stamp_ns > 2'010'000'000 && frame.stamp_ns < 2'090'000'000;
        frame.data = frame.id == 0x029 && between ? std::array<std::uint8_t, 64>{} : frame.data;
    });
    CHECK(replayed(arm, lost).positions > 350); // of 400
}

TEST_CASE("bus-off ends with a received frame, even without a report of the restart") {
    const Frames good = sound(icub());
    Frames off = with(good, error_frame(dfdyn::hal::error_class::bus_off));
    off.erase(off.begin() + std::ssize(off) / 2 + 1, off.begin() + std::ssize(off) / 2 + 400); // 0.1 s
    const Accepted accepted = replayed(icub(), off);
    CHECK(accepted.outputs > replayed(icub(), good).outputs - 100 - few);
}

TEST_CASE("a full scale of another set neither rescales nor rejects a wrench") {
    const dfdyn::hal::icub::StrainBoard board(13);
    const Frames good = sound(icub());
    for (const BusDescription& description : {icub(), icub_without_full_scales()}) {
        const int outputs = replayed(description, good).outputs;
        CHECK(outputs > 3900);
        for (int channel = 0; channel < 6; ++channel) {
            const Frames asked = with(good, board.encode_full_scale(channel, 500, 2));
            CHECK(replayed(description, asked).outputs == outputs);
        }
    }
}

TEST_CASE("a full scale that contradicts the description or an earlier one rescales no wrench") {
    const dfdyn::hal::icub::StrainBoard board(13);
    const Frames good = sound(icub());
    for (const BusDescription& description : {icub(), icub_without_full_scales()}) {
        const int outputs = replayed(description, good).outputs;
        Frames contradicted = with(good, board.encode_full_scale(0, 500));
        const Accepted refused = replayed(description, contradicted);
        CHECK(refused.outputs < outputs / 2 + few);
        CHECK(refused.refused.at("full_scale_contradicted") > outputs / 2 - few);
        const std::array<double, 6> full_scale{1500, 1500, 2000, 35, 35, 25};
        for (int channel = 0; channel < 6; ++channel) { // requested again immediately
            Frame reply = board.encode_full_scale(channel, full_scale[static_cast<std::size_t>(channel)]);
            const auto at = contradicted.begin() + std::ssize(contradicted) / 2 + 10;
            reply.stamp_ns = at->stamp_ns;
            contradicted.insert(at, reply);
        }
        CHECK(replayed(description, contradicted).outputs > outputs - few);
    }
}

TEST_CASE("with another set's full scales, a wrench is accepted only if that set is in use") {
    const Frames numbered = changed(sound(icub()), [](Frame& frame) {
        frame.data[1] = static_cast<std::uint8_t>(frame.data[1] | (frame.id == 0x2D0 ? 0x10 : 0));
    });
    const Accepted unknown = replayed(icub_without_full_scales(), numbered);
    CHECK(unknown.outputs == 0);
    CHECK(unknown.refused.at("waiting_for_full_scale") > 3900);
    CHECK(replayed(icub_without_full_scales(R"(, "calibration_set": 1)"), numbered).outputs > 3900);
}
