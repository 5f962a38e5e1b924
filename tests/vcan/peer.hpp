// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/socketcan_bus.hpp"
#include "tests/support/temporary_directory.hpp"

#include <array>
#include <chrono>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include <sys/types.h>

namespace dfdyn::tests {

/// Runs a shell command to its end and returns what it printed, standard error included. Throws
/// std::runtime_error with that when its status is not 0.
std::string run(const std::string& command);

/// The number that follows `words` in `text`, from where `begin` is. Throws std::runtime_error if they are
/// not there.
double number_after(const std::string& text, const std::string& words, const std::string& begin = "");

/// Whether the clock stands still while programs run: then nothing is ever late, and every run is the same.
bool virtual_time();

/// Calls `done` until it is true, for at most 5 s; whether it became true.
template <class Condition>
bool wait_for(Condition done) {
    for (int round = 0; round < 2500; ++round) {
        if (done()) {
            return true;
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    return done();
}

/// How many raw CAN sockets receive from an interface, in the whole network namespace.
long receivers();
/// Waits until there are more than `more_than`, for some seconds at most; whether there are.
bool wait_for_receivers(long more_than);

/// A program that runs beside the test, such as candump, with its output in a file.
class Background {
  public:
    enum class Ready { at_once, when_it_receives };

    /// `command` without shell syntax but for quotes. Returns at once, or when the program receives from a
    /// CAN interface or has ended; throws std::runtime_error when neither happens.
    explicit Background(const std::string& command, Ready ready = Ready::when_it_receives);
    /// Ends it by SIGTERM.
    ~Background();
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;

    void signal(int number) const;
    /// Its output so far, once that has `lines` lines, or what there is after some seconds.
    std::string output(std::size_t lines) const;

  private:
    TemporaryDirectory directory_;
    pid_t pid_;
};

/// A raw socket with none of our code between it and the kernel.
class RawSocket {
  public:
    explicit RawSocket(const std::string& interface);
    ~RawSocket();
    RawSocket(const RawSocket&) = delete;
    RawSocket& operator=(const RawSocket&) = delete;

    /// Sends a classic frame of 8 bytes with these 32 bits as identifier and flags. Whether the kernel took
    /// it.
    bool send(std::uint32_t can_id, const std::array<std::uint8_t, 8>& data) const;

  private:
    int descriptor_;
};

/// What `bus` drains until `count` frames came, or for some seconds.
std::vector<hal::Frame> receive(hal::SocketCanBus& bus, std::size_t count);

/// Drains and drops what waits.
void empty(hal::SocketCanBus& bus);

/// A bus on vcan0.
hal::SocketCanOptions on_vcan0();

} // namespace dfdyn::tests
