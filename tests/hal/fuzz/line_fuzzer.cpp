// SPDX-License-Identifier: Apache-2.0
// Parses arbitrary bytes as lines of a candump log. Each line is parsed or rejected with a position, and a
// parsed line can be written and parsed again.
#include "dfdyn/hal/candump.hpp"

#include <cstdlib>
#include <string_view>

namespace {

void require(bool held) {
    if (!held) {
        std::abort();
    }
}

void read(std::string_view line) {
    using dfdyn::hal::CandumpLine;
    const CandumpLine found = dfdyn::hal::parse_candump_line(line);
    if (found.kind == CandumpLine::Kind::malformed) {
        require(found.column >= 1 && found.column <= line.size() + 1);
    }
    if (found.kind == CandumpLine::Kind::frame) {
        require(dfdyn::hal::is_well_formed(found.frame));
        dfdyn::hal::CandumpText text{};
        const std::string_view again =
            dfdyn::hal::write_candump_line(found.frame, "can0", dfdyn::hal::StampDecimals::nanoseconds, text);
        require(again.empty() || dfdyn::hal::parse_candump_line(again).kind == CandumpLine::Kind::frame);
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    std::string_view text(reinterpret_cast<const char*>(data), size);
    while (!text.empty()) {
        const std::size_t end = text.find('\n');
        read(text.substr(0, end));
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    }
    return 0;
}
