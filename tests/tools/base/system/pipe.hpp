// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/catch.hpp"

#include <array>
#include <string>
#include <unistd.h>
#include <utility>

namespace dfdyn::tests {

class Pipe {
  public:
    Pipe() { REQUIRE(::pipe(ends_.data()) == 0); }
    ~Pipe() {
        close_reading_end();
        close_writing_end();
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    std::string writing_end() const { return "/dev/fd/" + std::to_string(ends_[1]); }
    void close_reading_end() { close_once(ends_[0]); }
    void close_writing_end() { close_once(ends_[1]); }

    /// Reads up to 10 kB, waits for the first byte, and returns nothing at the end.
    std::string read_some() const {
        std::array<char, 10'000> part{};
        const ssize_t count = ::read(ends_[0], part.data(), part.size());
        return {part.data(), count > 0 ? static_cast<std::size_t>(count) : 0};
    }

  private:
    static void close_once(int& end) {
        if (end >= 0) {
            ::close(std::exchange(end, -1));
        }
    }

    std::array<int, 2> ends_{};
};

} // namespace dfdyn::tests
