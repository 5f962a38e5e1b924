// SPDX-License-Identifier: Apache-2.0
#include "tools/can/log/frame_recorder.hpp"

#include "dfdyn/hal/candump.hpp"

#include <ostream>
#include <stdexcept>
#include <utility>

namespace dfdyn::tools {

FrameWriter::FrameWriter(std::ostream& out, std::string interface)
    : out_(out), interface_(std::move(interface)) {}

void FrameWriter::write(const hal::Frame& frame, std::uint64_t dropped) {
    if (dropped > 0) {
        dropped_ += dropped;
        out_ << "DROPCOUNT: dropped " << dropped << (dropped == 1 ? " CAN frame" : " CAN frames") << " on '"
             << interface_ << "' socket (total drops " << dropped_ << ")\n";
    }
    hal::CandumpText text;
    const std::string_view line =
        hal::write_candump_line(frame, interface_, hal::StampDecimals::nanoseconds, text);
    if (line.empty()) {
        throw std::logic_error("a frame that no log can hold");
    }
    out_ << line << '\n';
}

} // namespace dfdyn::tools
