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

/// Runs a shell command and returns its output including standard error. Throws std::runtime_error with the
/// output if its status is not 0.
std::string run(const std::string& command);

/// The number after `words` in `text`, searched from `begin` on. Throws std::runtime_error if they are
/// missing.
double number_after(const std::string& text, const std::string& words, const std::string& begin = "");

/// Whether the clock stops while programs run. Then nothing is ever late, and every run is the same.
bool virtual_time();

/// Returns whether the clock that is tested belongs to a kernel that was booted for the tests.
bool own_machine();

/// Returns whether loops can meet their deadlines: not in a kernel that was booted for the tests and shares
/// its core with the host, unless its time is virtual.
bool keeps_time();

/// Calls `done` until it returns true, for at most 5 s. Returns whether it did.
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

/// Number of raw CAN sockets that receive from an interface, in the whole network namespace.
long receivers();
/// Waits some seconds until there are more than `more_than` of them. Returns whether there are.
bool wait_for_receivers(long more_than);

/// A background program such as candump, with its output in a file.
class Background {
  public:
    enum class Ready { at_once, when_it_receives };

    /// Starts `command`, which may contain quotes but no other shell syntax. Returns at once, or when the
    /// program receives from a CAN interface or has ended. Throws std::runtime_error if neither happens.
    explicit Background(const std::string& command, Ready ready = Ready::when_it_receives);
    /// Ends the program with SIGTERM.
    ~Background();
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;

    void signal(int number) const;
    /// Output of the program. Waits some seconds until it has `lines` lines.
    std::string output(std::size_t lines) const;

  private:
    TemporaryDirectory directory_;
    pid_t pid_;
};

/// A raw socket, used directly without the bus layer.
class RawSocket {
  public:
    explicit RawSocket(const std::string& interface);
    ~RawSocket();
    RawSocket(const RawSocket&) = delete;
    RawSocket& operator=(const RawSocket&) = delete;

    /// Sends a classic frame of 8 bytes with these 32 bits of identifier and flags. Returns whether the
    /// kernel accepted it.
    bool send(std::uint32_t can_id, const std::array<std::uint8_t, 8>& data) const;

  private:
    int descriptor_;
};

/// Drains `bus` for some seconds until `count` frames have arrived, and returns them.
std::vector<hal::Frame> receive(hal::SocketCanBus& bus, std::size_t count);

/// Drains the waiting frames and drops them.
void empty(hal::SocketCanBus& bus);

/// A bus on vcan0.
hal::SocketCanOptions on_vcan0();

} // namespace dfdyn::tests
