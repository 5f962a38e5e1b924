// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/replay_bus.hpp"
#include "tests/tools/can/bus_check_support.hpp"
#include "tools/can/log/candump_log.hpp"
#include "tools/can/recognition/recognised_bus.hpp"

/// Logs of motors by an independent encoder (device_logs.py), and the rules of the findings on buses without
/// a description.
namespace dfdyn::tests {

inline const std::string device_folder = bus_folder + "devices/";

inline Frames log_of(const std::string& name) {
    tools::CandumpLog log(device_folder + name + ".log");
    Frames frames;
    hal::ReplayEntry entry;
    while (log.next(entry)) {
        frames.push_back(entry.frame);
    }
    log.check();
    return frames;
}

inline Names rules_of(const tools::RecognisedBus& bus) {
    Names names;
    for (const tools::BusFinding& finding : bus.findings) {
        names.insert(finding.rule);
    }
    return names;
}

inline Names rules_without_description(const Frames& frames) {
    return rules_of(tools::recognise_bus(frames));
}

} // namespace dfdyn::tests
