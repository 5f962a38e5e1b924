// SPDX-License-Identifier: Apache-2.0
#include "tools/common/progress.hpp"

#include <array>
#include <cstdio>
#include <utility>

namespace dfdyn::tools {
namespace {

constexpr std::chrono::milliseconds period{100};
constexpr const char* erase_line = "\r\x1b[K";

} // namespace

Progress::Progress(std::string label, std::size_t total, int descriptor)
    : label_(std::move(label)), total_(total), descriptor_(descriptor), terminal_(::isatty(descriptor) == 1),
      next_(std::chrono::steady_clock::now() + period) {}

Progress::~Progress() {
    if (visible_) {
        write(erase_line);
    }
}

void Progress::update(std::size_t done) {
    if (due()) {
        show(std::to_string(done), static_cast<double>(done));
    }
}

void Progress::update_part(double done) {
    if (due()) {
        std::array<char, 48> text{};
        std::snprintf(text.data(), text.size(), "%.1f", done);
        show(text.data(), done);
    }
}

bool Progress::due() const { return terminal_ && std::chrono::steady_clock::now() >= next_; }

void Progress::show(const std::string& shown, double done) {
    std::string line = erase_line + label_ + ": " + shown;
    if (total_ > 0) {
        const double percent = 100.0 * done / static_cast<double>(total_);
        line += " of " + std::to_string(total_) + " (" + std::to_string(static_cast<int>(percent)) + " %)";
    }
    write(line);
    visible_ = true;
    next_ = std::chrono::steady_clock::now() + period;
}

/// A terminal that does not take the line loses nothing that matters.
void Progress::write(const std::string& text) const {
    [[maybe_unused]] const ssize_t count = ::write(descriptor_, text.data(), text.size());
}

} // namespace dfdyn::tools
