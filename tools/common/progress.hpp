// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <unistd.h>

namespace dfdyn::tools {

/// One line on the terminal that shows how far a long work is, at most ten times a second; nothing at all
/// where `descriptor` is no terminal, or the work takes less than a tenth of a second. The line is gone when
/// the object is. One thread.
class Progress {
  public:
    /// `total`: what `done` ends at; 0 when nobody knows.
    explicit Progress(std::string label, std::size_t total, int descriptor = STDERR_FILENO);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Cheap enough for every row: reads a clock, and only on a terminal.
    void update(std::size_t done);

    /// The same where parts of one count; shows tenths.
    void update_part(double done);

  private:
    bool due() const;
    void show(const std::string& shown, double done);
    void write(const std::string& text) const;

    std::string label_;
    std::size_t total_;
    int descriptor_;
    bool terminal_;
    bool visible_ = false;
    std::chrono::steady_clock::time_point next_;
};

} // namespace dfdyn::tools
