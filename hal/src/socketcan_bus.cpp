// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/socketcan_bus.hpp"

#include "dfdyn/hal/bus_event.hpp"
#include "hal/src/can_frame.hpp"
#include "hal/src/can_socket.hpp"

#include <array>
#include <cerrno>
#include <ctime>
#include <limits>
#include <utility>

#include <linux/can/error.h>
#include <linux/errqueue.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace dfdyn::hal {
namespace {

static_assert(error_class::transmit_timeout == CAN_ERR_TX_TIMEOUT &&
              error_class::lost_arbitration == CAN_ERR_LOSTARB && error_class::controller == CAN_ERR_CRTL &&
              error_class::protocol == CAN_ERR_PROT && error_class::transceiver == CAN_ERR_TRX &&
              error_class::no_acknowledgement == CAN_ERR_ACK && error_class::bus_off == CAN_ERR_BUSOFF &&
              error_class::bus_error == CAN_ERR_BUSERROR && error_class::restarted == CAN_ERR_RESTARTED);
static_assert(controller_detail::receive_overflow == CAN_ERR_CRTL_RX_OVERFLOW &&
              controller_detail::transmit_overflow == CAN_ERR_CRTL_TX_OVERFLOW &&
              controller_detail::warning == (CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING) &&
              controller_detail::passive == (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE) &&
              controller_detail::active == CAN_ERR_CRTL_ACTIVE);

std::int64_t clock_ns(clockid_t clock) noexcept {
    timespec time{};
    ::clock_gettime(clock, &time);
    return nanoseconds(time);
}

/// Both clocks at the same time.
struct Clocks {
    std::int64_t monotonic_ns = 0;
    std::int64_t wall_ns = 0;
};

/// Reads both clocks. Repeats the reading, up to four times in all, if the program was interrupted in
/// between.
Clocks read_clocks() noexcept {
    constexpr std::int64_t close_ns = 50'000;
    Clocks best;
    std::int64_t least_gap_ns = std::numeric_limits<std::int64_t>::max();
    for (int attempt = 0; attempt < 4 && least_gap_ns > close_ns; ++attempt) {
        const std::int64_t before_ns = clock_ns(CLOCK_MONOTONIC);
        const std::int64_t wall_ns = clock_ns(CLOCK_REALTIME);
        const std::int64_t gap_ns = clock_ns(CLOCK_MONOTONIC) - before_ns;
        if (gap_ns < least_gap_ns) {
            best = {before_ns + gap_ns / 2, wall_ns};
            least_gap_ns = gap_ns;
        }
    }
    return best;
}

void check_name(const std::string& interface) {
    if (interface.empty() || interface.size() >= IFNAMSIZ || interface.find('\0') != std::string::npos) {
        throw BusError("CAN interface: expected a name of 1 to 15 characters, found " +
                       std::to_string(interface.size()));
    }
}

bool has_more(int descriptor) noexcept {
    pollfd waiting{descriptor, POLLIN, 0};
    return ::poll(&waiting, 1, 0) == 1 && (waiting.revents & POLLIN) != 0;
}

} // namespace

SocketCanBus::SocketCanBus(SocketCanOptions options) : options_(std::move(options)) {
    check_name(options_.interface);
    for (const IdFilter& filter : options_.filters) {
        kernel_filters_.push_back(kernel_filter(filter));
    }
    OpenFault fault;
    descriptor_ = open_can_socket(options_, kernel_filters_, fault);
    if (descriptor_ < 0) {
        throw open_error(options_.interface, fault);
    }
    nothing_waiting();
    if (!interface_is_up(descriptor_, options_.interface)) {
        go_down();
    }
}

SocketCanBus::~SocketCanBus() { ::close(descriptor_); }

std::span<const Frame> SocketCanBus::drain(std::span<Frame> into) noexcept {
    if (state_ == BusState::interface_down) {
        reopen_if_up();
    }
    std::size_t count = 0;
    std::size_t reads = 0;
    Reading reading = Reading::frame;
    while (reads < into.size() && reading != Reading::nothing) {
        reading = read_frame(into[count]);
        count += reading == Reading::frame ? 1 : 0;
        ++reads;
    }
    counters_.saturated_drains += reading != Reading::nothing && has_more(descriptor_) ? 1 : 0;
    return into.first(count);
}

void SocketCanBus::wait(std::int64_t timeout_ns) const noexcept {
    constexpr std::int64_t nanoseconds_per_s = 1'000'000'000;
    const timespec timeout{static_cast<time_t>(timeout_ns / nanoseconds_per_s),
                           static_cast<long>(timeout_ns % nanoseconds_per_s)};
    // The socket of an interface that is down has no frames, but is always ready with an error.
    pollfd waiting{state_ == BusState::interface_down ? -1 : descriptor_, POLLIN, 0};
    ::ppoll(&waiting, 1, &timeout, nullptr);
}

/// Reads at most one frame, with one system call.
SocketCanBus::Reading SocketCanBus::read_frame(Frame& frame) noexcept {
    canfd_frame raw{};
    iovec part{&raw, sizeof(raw)};
    alignas(cmsghdr)
        std::array<char, CMSG_SPACE(sizeof(scm_timestamping)) + CMSG_SPACE(sizeof(std::uint32_t))>
            control{};
    msghdr message{};
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    message.msg_control = control.data();
    message.msg_controllen = control.size();
    const ssize_t size = ::recvmsg(descriptor_, &message, MSG_DONTWAIT);
    if (size < 0) {
        return no_frame(errno);
    }
    if (size != CAN_MTU && size != CANFD_MTU) {
        ++counters_.truncated;
        return Reading::skipped;
    }
    frame = {};
    decode_can_frame(raw, static_cast<std::size_t>(size), frame);
    frame.origin = origin_of(message.msg_flags);
    stamp(message, frame);
    ++counters_.received;
    note_frame(frame, state_, counters_);
    return Reading::frame;
}

void SocketCanBus::nothing_waiting() noexcept {
    const Clocks now = read_clocks();
    wall_clock_.nothing_waiting(now.monotonic_ns, now.wall_ns);
}

SocketCanBus::Reading SocketCanBus::no_frame(int error_number) noexcept {
    if (error_number == EAGAIN || error_number == EINTR) {
        nothing_waiting();
        return Reading::nothing;
    }
    // ENETDOWN, ENODEV or another error that a working interface never gives. It is reported before waiting
    // frames.
    go_down();
    return Reading::skipped;
}

void SocketCanBus::stamp(const msghdr& message, Frame& frame) noexcept {
    const Ancillary with = ancillary_of(message);
    if (with.has_drops) {
        count_drops(with.drops);
    }
    const Clocks now = read_clocks();
    const auto [stamp_ns, plausible] =
        wall_clock_.to_monotonic(with.software_ns, now.monotonic_ns, now.wall_ns);
    if (with.hardware_ns != 0) {
        frame.stamp_ns = hardware_clock_.to_monotonic(with.hardware_ns, now.monotonic_ns);
        frame.stamp_source = StampSource::hardware;
    } else if (with.software_ns != 0 && plausible) {
        frame.stamp_ns = stamp_ns;
        frame.stamp_source = StampSource::kernel;
    } else {
        frame.stamp_ns = now.monotonic_ns;
        frame.stamp_source = StampSource::arrival;
    }
}

/// Adds the increase of the kernel's counter, which has 32 bits and wraps.
void SocketCanBus::count_drops(std::uint32_t total) noexcept {
    counters_.dropped += static_cast<std::uint32_t>(total - kernel_drops_);
    kernel_drops_ = total;
}

void SocketCanBus::go_down() noexcept {
    counters_.interface_down += state_ == BusState::interface_down ? 0 : 1;
    state_ = BusState::interface_down;
}

/// Opens a new socket: the interface of the old one may have been removed together with the filters.
void SocketCanBus::reopen_if_up() noexcept {
    if (!interface_is_up(descriptor_, options_.interface)) {
        return;
    }
    OpenFault ignored;
    const int descriptor = open_can_socket(options_, kernel_filters_, ignored);
    if (descriptor < 0) {
        return;
    }
    ::close(descriptor_);
    descriptor_ = descriptor;
    kernel_drops_ = 0;
    hardware_clock_ = {};
    state_ = BusState::active;
}

SendResult SocketCanBus::send(const Frame& frame) noexcept {
    if (!is_well_formed(frame) || frame.error) {
        return SendResult::invalid;
    }
    if (state_ == BusState::off || state_ == BusState::interface_down) {
        return SendResult::bus_closed;
    }
    const canfd_frame raw = encode_can_frame(frame);
    if (::send(descriptor_, &raw, frame.fd ? CANFD_MTU : CAN_MTU, MSG_DONTWAIT) >= 0) {
        ++counters_.sent;
        return SendResult::sent;
    }
    switch (errno) {
    case ENOBUFS:
    case EAGAIN:
    case EINTR:
        ++counters_.send_refused;
        return SendResult::refused;
    case EINVAL:
    case EMSGSIZE:
        return SendResult::invalid;
    default:
        go_down();
        return SendResult::bus_closed;
    }
}

std::int64_t SocketCanBus::now_ns() const noexcept { return clock_ns(CLOCK_MONOTONIC); }

} // namespace dfdyn::hal
