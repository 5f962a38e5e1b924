// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/quiet.hpp"

#include <atomic>
#include <iostream>

namespace dfdyn::tools {
namespace {

std::atomic<bool> without_notes = false;

} // namespace

void be_quiet() noexcept { without_notes = true; }

bool quiet() noexcept { return without_notes; }

void print_note(std::string_view line) {
    if (!quiet()) {
        std::cerr << line << '\n';
    }
}

} // namespace dfdyn::tools
