// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/hal/bus.hpp"
#include "dfdyn/hal/frame.hpp"
#include "dfdyn/hal/wall_clock.hpp"

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

struct msghdr;

namespace dfdyn::hal {

/// Error when a bus cannot be opened: one line with the interface, what was expected and what was found.
class BusError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Accepts frames with `(frame id & mask) == (id & mask)` and the same kind of identifier.
struct IdFilter {
    std::uint32_t id = 0;   ///< 11 or 29 bits
    std::uint32_t mask = 0; ///< bits that are compared; 0: every identifier of this kind
    bool extended = false;  ///< 29-bit identifiers
};

/// Options of a `SocketCanBus`.
struct SocketCanOptions {
    std::string interface;              ///< such as `can0`
    std::vector<IdFilter> filters = {}; ///< empty: all frames; error frames are received in any case
    /// also receive the frames that this bus itself sent, once they are on the wire
    bool receive_own = false;
};

/// A CAN interface of Linux (`Bus`), classic or FD. The constructor opens it. Afterwards no call allocates or
/// throws, only `wait` blocks, and each call makes a bounded number of system calls. `drain` makes one read
/// per frame of room, besides readings of the clock.
///
/// **Clock.** `now_ns` is CLOCK_MONOTONIC. The kernel stamps a frame in its interrupt handler with the wall
/// clock (CLOCK_REALTIME). When the frame is read, its time stamp is converted by the difference of the two
/// clocks at that time. Setting the wall clock (NTP, the user) therefore does not move the samples. Frames
/// that were waiting or being delivered meanwhile are converted by the difference before the change (see
/// WallClock). If the controller has its own time stamps, they are used, converted by the smallest delay
/// observed (see HardwareClock). `Frame::stamp_source` names the clock used; a frame without a usable time
/// stamp gets the time of reading.
///
/// **Losses.** Frames that the kernel dropped because nobody read them are counted as `dropped` when the next
/// frame arrives.
///
/// **Interface down or unplugged.** `state()` becomes `interface_down`; a silent bus never causes this. Each
/// later drain checks once whether the interface is up again, and then reopens it.
class SocketCanBus {
  public:
    /// Throws BusError: no such interface, not a CAN interface, no CAN in this kernel, or no permission. An
    /// interface that exists but is down is no error: the bus opens when it comes up.
    explicit SocketCanBus(SocketCanOptions options);
    ~SocketCanBus();
    SocketCanBus(const SocketCanBus&) = delete;
    SocketCanBus& operator=(const SocketCanBus&) = delete;

    /// Returns the received frames in the order of arrival, at most `into.size()`, as the filled part of
    /// `into`.
    std::span<const Frame> drain(std::span<Frame> into) noexcept;

    /// Sleeps until a frame arrives, a signal arrives or `timeout_ns` has passed. For programs that have
    /// nothing else to do. The only call that blocks.
    void wait(std::int64_t timeout_ns) const noexcept;

    /// Passes `frame` to the kernel's queue; a full queue (ENOBUFS) refuses it immediately. The queue of a
    /// CAN interface is short: it holds 10 frames unless `ip link set IFACE txqueuelen 100` made it longer.
    SendResult send(const Frame& frame) noexcept;

    /// Returns CLOCK_MONOTONIC.
    std::int64_t now_ns() const noexcept;
    /// Returns the state after the last drain or send.
    BusState state() const noexcept { return state_; }
    /// Returns the counters after the last drain or send.
    const BusCounters& counters() const noexcept { return counters_; }

  private:
    enum class Reading : std::uint8_t { frame, nothing, skipped };

    Reading read_frame(Frame& frame) noexcept;
    Reading no_frame(int error_number) noexcept;
    void nothing_waiting() noexcept;
    void stamp(const msghdr& message, Frame& frame) noexcept;
    void count_drops(std::uint32_t total) noexcept;
    void go_down() noexcept;
    void reopen_if_up() noexcept;

    SocketCanOptions options_;
    std::vector<std::uint64_t> kernel_filters_; ///< identifier and mask in the kernel's format, 4 bytes each
    int descriptor_ = -1;
    std::uint32_t kernel_drops_ = 0; ///< drop counter of this socket, modulo 2^32
    WallClock wall_clock_;
    HardwareClock hardware_clock_;
    BusState state_ = BusState::active;
    BusCounters counters_{};
};

} // namespace dfdyn::hal
