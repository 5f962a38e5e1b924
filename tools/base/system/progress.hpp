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

/// Shows on standard error how far a long work is.
///
/// On a terminal: one line with a bar, at most ten times a second, that is erased in the end. Elsewhere (a
/// pipe, a log file): plain lines, at most one every `plain_period` over all objects of the program, so that
/// work of a few seconds writes nothing. One thread.
class Progress {
  public:
    static constexpr std::chrono::milliseconds plain_period{10'000};

    /// `total`: what `done` ends at; 0 when nobody knows. `plain`: the period of plain lines, for tests.
    explicit Progress(std::string label, std::size_t total, int descriptor = STDERR_FILENO,
                      std::chrono::milliseconds plain = plain_period);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Cheap enough for every row: reads a clock.
    void update(std::size_t done);

    /// The same where parts of one count; shows tenths.
    void update_part(double done);

    /// Shows `text` in place of a count.
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

/// Shows that a work goes on which does not report how far it is: its label and the seconds since it began,
/// as a Progress does. A thread of its own writes; it ends with the object.
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
    std::thread thread_; // last: begins when the rest is there
};

} // namespace dfdyn::tools
