// SPDX-License-Identifier: Apache-2.0
#include "tools/base/system/progress.hpp"

#include "tools/base/system/quiet.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdio>
#include <utility>

namespace dfdyn::tools {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds period{100};
constexpr const char* erase_line = "\r\x1b[K";
constexpr int bar_width = 20;

/// Time of the last plain line, or of the construction of the first Progress.
std::atomic<Clock::time_point>& last_plain_line() {
    static std::atomic<Clock::time_point> last{Clock::now()};
    return last;
}

std::string bar(double share) {
    const int filled = std::clamp(static_cast<int>(bar_width * share), 0, bar_width);
    return "[" + std::string(static_cast<std::size_t>(filled), '#') +
           std::string(static_cast<std::size_t>(bar_width - filled), '.') + "] ";
}

} // namespace

Progress::Progress(std::string label, std::size_t total, int descriptor, std::chrono::milliseconds plain)
    : label_(std::move(label)), total_(total), descriptor_(descriptor), plain_(plain),
      terminal_(::isatty(descriptor) == 1), next_(Clock::now() + period) {
    last_plain_line();
}

Progress::~Progress() {
    if (visible_ && terminal_) {
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

void Progress::update_text(const std::string& text) {
    if (due()) {
        show(text, 0);
    }
}

bool Progress::due() const {
    const auto now = Clock::now();
    return !quiet() && now >= next_ && (terminal_ || now >= last_plain_line().load() + plain_);
}

void Progress::show(const std::string& shown, double done) {
    std::string line = label_ + ": ";
    if (total_ > 0) {
        const double share = done / static_cast<double>(total_);
        line += (terminal_ ? bar(share) : std::string()) + shown + " of " + std::to_string(total_) + " (" +
                std::to_string(static_cast<int>(100 * share)) + " %)";
    } else {
        line += shown;
    }
    write(terminal_ ? erase_line + line : line + "\n");
    visible_ = true;
    next_ = Clock::now() + period;
    last_plain_line() = Clock::now();
}

/// Errors are ignored, because progress lines are not essential.
void Progress::write(const std::string& text) const {
    [[maybe_unused]] const ssize_t count = ::write(descriptor_, text.data(), text.size());
}

Activity::Activity(std::string label, int descriptor, std::chrono::milliseconds plain)
    : thread_(&Activity::run, this, std::move(label), descriptor, plain) {}

Activity::~Activity() {
    {
        const std::lock_guard lock(mutex_);
        ended_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void Activity::run(std::string label, int descriptor, std::chrono::milliseconds plain) {
    Progress progress(std::move(label), 0, descriptor, plain);
    const auto begin = Clock::now();
    std::unique_lock lock(mutex_);
    while (!changed_.wait_for(lock, period + std::chrono::milliseconds(5), [this] { return ended_; })) {
        const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - begin).count();
        progress.update_text(std::to_string(seconds) + " s");
    }
}

} // namespace dfdyn::tools
