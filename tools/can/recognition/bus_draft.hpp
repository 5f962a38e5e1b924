// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/can/recognition/recognised_bus.hpp"

namespace dfdyn::tools {

/// Makes a draft of the description of a recognised family with efforts (`dfdyn.bus/1`). `frames`: those of
/// the bus. Adds what the draft assumes, and the boards beyond its largest number of joints, to the family's
/// uncertain properties. Throws InputError if a rate of the boards is unknown.
nlohmann::json draft_of(RecognisedFamily& known, std::span<const hal::Frame> frames);

} // namespace dfdyn::tools
