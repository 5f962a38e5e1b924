// SPDX-License-Identifier: Apache-2.0
// Two devices that send on the identifier of one joint: the effect on `replay` with every trigger.
#include "tests/tools/can/bus_check_support.hpp"
#include "tools/can/arm/bus_sampler.hpp"

#include <map>

namespace {

using namespace dfdyn::tests;
using dfdyn::tools::BusSample;
using dfdyn::tools::BusTraffic;
using dfdyn::tools::BusTrigger;

/// The frames of an arm, and those of another arm on the identifier of joint 1, delayed by a fraction of a
/// period.
Frames with_two_senders(const BusDescription& description, double later, double from_s) {
    const std::uint32_t id = description.boards.front().board.encode({}).frame[0].id;
    const auto delay_ns = std::llround(later * 1e9 / description.joints.rate_hz);
    Frames frames = sound(description);
    for (Frame frame : sound(description, 4, 20, 0.5)) {
        if (frame.id == id && 1e-9 * static_cast<double>(frame.stamp_ns) > from_s) {
            frame.stamp_ns += delay_ns;
            frames.push_back(frame);
        }
    }
    return dfdyn::tests::changed(frames, [](Frame&) {});
}

} // namespace

TEST_CASE("no position of two senders on one identifier is accepted, for any family and trigger") {
    for (const char* const name : {"icub_arm_strain", "ur5_cia402", "ur5_icub_2foc", "ur5_dbc", "odrive"}) {
        for (const BusTrigger trigger : {BusTrigger::timer, BusTrigger::set, BusTrigger::sync}) {
            BusDescription description =
                std::string(name) == "odrive"
                    ? described(odrive_and_ati)
                    : dfdyn::tools::read_bus_description(bus_folder + name + ".json");
            if (trigger == BusTrigger::sync && description.trigger != BusTrigger::sync) {
                continue; // its drives do not measure at a SYNC
            }
            description.trigger = trigger;
            for (const double later : {0.2, 0.5, 0.8}) {
                const double from_s = GENERATE(0.0, 2.0);
                std::map<std::string, int> reasons;
                int wrong = 0;
                dfdyn::tools::BusSampler sampler(description, [&](const BusSample& sample) {
                    const double t = 1e-9 * static_cast<double>(sample.sample.time_ns - BusTraffic::lead_ns);
                    ++reasons[dfdyn::hal::name(sample.report.position)];
                    for (std::size_t i = 0; sample.valid() && i < sample.positions().size(); ++i) {
                        const double truth = 0.4 + 0.2 * std::sin(t + static_cast<double>(i));
                        wrong += std::abs(sample.positions()[i] - truth) > 5e-3 ? 1 : 0;
                    }
                });
                for (const Frame& frame : with_two_senders(description, later, from_s)) {
                    sampler.take(frame, dfdyn::hal::BusState::active, {});
                }
                CAPTURE(name, static_cast<int>(trigger), later, from_s, reasons);
                CHECK(wrong == 0);
                // Two answers to one SYNC have the same time stamp and are rejected for that reason.
                CHECK((description.synchronous || reasons["id_collision"] > 0));
                CHECK((from_s == 0 || reasons["ok"] > 0)); // while there was only one sender
            }
        }
    }
}
