// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/frame.hpp"
#include "tools/can/check/bus_stream.hpp"

#include <nlohmann/json.hpp>

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// A board that a family has recognised.
struct RecognisedBoard {
    std::string name = {};     ///< such as `motor 4`
    nlohmann::json entry = {}; ///< entry of `boards`, without its joints
    int joints = 1;
    double rate_hz = 0;        ///< rate of its positions
    std::string measured = {}; ///< other results from its frames; "": none
};

/// A motor that is commanded or polled but never answers.
struct SilentMotor {
    unsigned motor = 0;
    std::set<BusStreamKey> commands = {}; ///< identifiers of the commands and polls
};

/// Result of a family's recognition in the frames of a bus without a description.
struct Recognition {
    std::vector<RecognisedBoard>
        boards; ///< in the order of the joints, base to tip, as far as it can be inferred
    nlohmann::json fields = nlohmann::json::object(); ///< of `joints`
    std::string quantity;                             ///< kind of its efforts: `tau`, `i`; "": none
    std::vector<std::string> unsure;                  ///< properties that the frames alone do not determine
    std::vector<SilentMotor> silent;
    /// Explained identifiers: of answers, and of commands that are clearly for its motors.
    std::set<BusStreamKey> identifiers;
    /// Further identifiers of its boards, which are not commands to motors of other families.
    std::set<BusStreamKey> reserved;
    double score = 0; ///< number of frames, weighted by how well they fit; compared between families
};

/// Frames in order of time.
using FrameSpan = std::span<const hal::Frame>;

} // namespace dfdyn::tools
