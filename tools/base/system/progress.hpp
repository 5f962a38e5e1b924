// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <thread>
#include <unistd.h>

namespace dfdyn::tools {

/// Shows the progress of long work on standard error.
///
/// On a terminal: one line with a bar, updated at most ten times a second, and erased at the end. Elsewhere
/// (a pipe, a log file): plain lines, at most one every `plain_period` over all objects of the program, so
/// that work of a few seconds writes nothing. For use by one thread.
class Progress {
  public:
    static constexpr std::chrono::milliseconds plain_period{10'000};

    /// `total`: final value of `done`; 0 if unknown. `plain`: the period of plain lines, for tests.
    explicit Progress(std::string label, std::size_t total, int descriptor = STDERR_FILENO,
                      std::chrono::milliseconds plain = plain_period);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Updates the count. Cheap enough for every row: it reads a clock.
    void update(std::size_t done);

    /// Updates a fractional count; shows tenths.
    void update_part(double done);

    /// Shows `text` instead of a count.
    void update_text(const std::string& text);

  private:
    bool due() const;
    void show(const std::string& shown, double done);
    void write(const std::string& text) const;

    std::string label_;
    std::size_t total_;
    int descriptor_;
    std::chrono::milliseconds plain_;
    bool terminal_;
    bool visible_ = false;
    std::chrono::steady_clock::time_point next_;
};

/// Shows the activity of work without a progress count: its label and the elapsed seconds, like a Progress. A
/// thread of its own writes them until the object is destroyed.
class Activity {
  public:
    explicit Activity(std::string label, int descriptor = STDERR_FILENO,
                      std::chrono::milliseconds plain = Progress::plain_period);
    ~Activity();
    Activity(const Activity&) = delete;
    Activity& operator=(const Activity&) = delete;

  private:
    void run(std::string label, int descriptor, std::chrono::milliseconds plain);

    std::mutex mutex_;
    std::condition_variable changed_;
    bool ended_ = false;
    std::thread thread_; // last: starts after the other members exist
};

} // namespace dfdyn::tools
