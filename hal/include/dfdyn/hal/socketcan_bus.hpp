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

/// Why a bus cannot be opened: one line that says which interface, what was expected and what was found.
class BusError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Frames that the kernel hands on: those with `(id & mask) == (this id & mask)`, of one kind of identifier.
struct IdFilter {
    std::uint32_t id = 0;
    std::uint32_t mask = 0;
    bool extended = false;
};

struct SocketCanOptions {
    std::string interface;              ///< such as `can0`
    std::vector<IdFilter> filters = {}; ///< none: all frames. Error frames come in any case.
    bool receive_own = false;           ///< hand out what this bus itself sent, once it is on the wire
};

/// A CAN interface of Linux (`Bus`), classic or FD. Opens in its constructor; from then on no call allocates
/// or throws, none but `wait` waits, and each makes a bounded number of system calls: `drain` one read per
/// frame of room, beside readings of the clock.
///
/// **Clock.** `now_ns` is CLOCK_MONOTONIC. The kernel stamps a frame at reception, in the interrupt, by the
/// wall clock (CLOCK_REALTIME); on reading, the stamp moves by the difference that the two clocks have then,
/// so that a wall clock that is set (NTP, the user) does not move the samples; frames that waited meanwhile
/// move by the difference before (see WallClock). Where the controller has stamps of its own, those are used,
/// moved by the least delay seen (see HardwareClock). `Frame::stamp_source` says which it was; a frame with
/// no usable stamp has the time of reading.
///
/// **Losses.** Frames that the kernel dropped because nobody read them are known, and counted as `dropped`,
/// when the next frame arrives.
///
/// **Interface down or unplugged.** `state()` becomes `interface_down`, which a silent bus never does; each
/// later drain looks once whether the interface is up again, and then opens it anew.
class SocketCanBus {
  public:
    /// Throws BusError: no such interface, not a CAN interface, no CAN in this kernel, no permission. An
    /// interface that is there but down is no error: the bus opens when it comes up.
    explicit SocketCanBus(SocketCanOptions options);
    ~SocketCanBus();
    SocketCanBus(const SocketCanBus&) = delete;
    SocketCanBus& operator=(const SocketCanBus&) = delete;

    std::span<const Frame> drain(std::span<Frame> into) noexcept;

    /// Sleeps until a frame waits, a signal comes or `timeout_ns` has passed, whichever is first: for
    /// programs that have nothing else to do. The only call that waits.
    void wait(std::int64_t timeout_ns) const noexcept;

    /// Hands `frame` to the kernel's queue; a full queue (ENOBUFS) refuses it at once. That happens early:
    /// the queue of a CAN interface holds 10 frames, unless `ip link set IFACE txqueuelen 100` made it
    /// longer.
    SendResult send(const Frame& frame) noexcept;

    std::int64_t now_ns() const noexcept;
    BusState state() const noexcept { return state_; }
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
    std::vector<std::uint64_t>
        kernel_filters_; ///< as the kernel wants them: identifier and mask, 4 bytes each
    int descriptor_ = -1;
    std::uint32_t kernel_drops_ = 0; ///< of this socket, modulo 2^32
    WallClock wall_clock_;
    HardwareClock hardware_clock_;
    BusState state_ = BusState::active;
    BusCounters counters_{};
};

} // namespace dfdyn::hal
