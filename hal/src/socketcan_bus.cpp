// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/socketcan_bus.hpp"

#include "dfdyn/hal/bus_event.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <limits>
#include <string_view>
#include <system_error>
#include <utility>

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/errqueue.h>
#include <linux/net_tstamp.h>
#include <net/if.h>
#include <poll.h>
#include <sys/ioctl.h>
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
static_assert(sizeof(can_filter) == sizeof(std::uint64_t));

std::int64_t nanoseconds(const timespec& time) noexcept {
    return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

std::int64_t clock_ns(clockid_t clock) noexcept {
    timespec time{};
    ::clock_gettime(clock, &time);
    return nanoseconds(time);
}

/// What both clocks show at one time.
struct Clocks {
    std::int64_t monotonic_ns = 0;
    std::int64_t wall_ns = 0;
};

/// Reads both, again where the program was held up in between, and at most four times.
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

std::uint64_t kernel_filter(const IdFilter& filter) noexcept {
    can_filter out{};
    out.can_id = filter.id | (filter.extended ? CAN_EFF_FLAG : 0U);
    out.can_mask = filter.mask | CAN_EFF_FLAG;
    return std::bit_cast<std::uint64_t>(out);
}

/// What went wrong in opening: which step, and the system's number.
struct OpenFault {
    const char* step = nullptr; ///< null: nothing
    int error_number = 0;
};

template <class Value>
bool set_option(int descriptor, int level, int name, const Value& value) noexcept {
    return ::setsockopt(descriptor, level, name, &value, sizeof(value)) == 0;
}

/// The flags of interface `name` (IFF_UP and so on), or -1 where there is none.
int interface_flags(int descriptor, const std::string& name) noexcept {
    ifreq request{};
    name.copy(request.ifr_name, IFNAMSIZ - 1);
    return ::ioctl(descriptor, SIOCGIFFLAGS, &request) == 0 ? request.ifr_flags & 0xffff : -1;
}

bool is_up(int flags) noexcept { return flags >= 0 && (flags & IFF_UP) != 0; }

bool set_options(int descriptor, std::span<const std::uint64_t> filters, bool receive_own) noexcept {
    constexpr can_err_mask_t all_errors = CAN_ERR_MASK;
    constexpr int stamps = static_cast<int>(SOF_TIMESTAMPING_RX_HARDWARE) | SOF_TIMESTAMPING_RX_SOFTWARE |
                           SOF_TIMESTAMPING_RAW_HARDWARE | SOF_TIMESTAMPING_SOFTWARE;
    const bool filtered =
        filters.empty() || ::setsockopt(descriptor, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                                        static_cast<socklen_t>(filters.size_bytes())) == 0;
    return filtered && set_option(descriptor, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, all_errors) &&
           set_option(descriptor, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, 1) &&
           set_option(descriptor, SOL_CAN_RAW, CAN_RAW_RECV_OWN_MSGS, receive_own ? 1 : 0) &&
           set_option(descriptor, SOL_SOCKET, SO_TIMESTAMPING, stamps) &&
           set_option(descriptor, SOL_SOCKET, SO_RXQ_OVFL, 1);
}

/// Opens a socket on `options.interface`; -1 and `fault` where that fails.
int open_socket(const SocketCanOptions& options, std::span<const std::uint64_t> filters,
                OpenFault& fault) noexcept {
    const int descriptor = ::socket(AF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
    if (descriptor < 0) {
        fault = {"a CAN socket", errno};
        return -1;
    }
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(options.interface.c_str()));
    if (!set_options(descriptor, filters, options.receive_own)) {
        fault = {"a CAN socket with filters, error frames, CAN FD, stamps and drop counts", errno};
    } else if (address.can_ifindex == 0) { // bound to 0 it would receive from every interface
        fault = {"a CAN interface of this name", errno};
    } else if (::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
        fault = {"a CAN interface", errno};
    } else {
        return descriptor;
    }
    ::close(descriptor);
    return -1;
}

BusError open_error(const std::string& interface, const OpenFault& fault) {
    std::string found = std::system_category().message(fault.error_number);
    if (fault.error_number == EAFNOSUPPORT || fault.error_number == EPROTONOSUPPORT) {
        found = "a kernel without CAN (its modules: can, can-raw): " + found;
    } else if (fault.error_number == ENODEV && ::if_nametoindex(interface.c_str()) != 0) {
        found = "an interface of another kind";
    }
    return BusError(interface + ": expected " + fault.step + ", found: " + found);
}

void check_name(const std::string& interface) {
    if (interface.empty() || interface.size() >= IFNAMSIZ || interface.find('\0') != std::string::npos) {
        throw BusError("CAN interface: expected a name of 1 to 15 characters, found " +
                       std::to_string(interface.size()));
    }
}

/// The frame in the first `size` bytes of `raw`, which are a classic frame's or an FD frame's.
void decode(const canfd_frame& raw, std::size_t size, Frame& frame) noexcept {
    frame.fd = size == CANFD_MTU;
    frame.error = (raw.can_id & CAN_ERR_FLAG) != 0;
    frame.extended = !frame.error && (raw.can_id & CAN_EFF_FLAG) != 0;
    frame.remote = !frame.error && !frame.fd && (raw.can_id & CAN_RTR_FLAG) != 0;
    frame.id = raw.can_id & (frame.extended || frame.error ? CAN_EFF_MASK : CAN_SFF_MASK);
    frame.bit_rate_switch = frame.fd && (raw.flags & CANFD_BRS) != 0;
    frame.error_state_indicator = frame.fd && (raw.flags & CANFD_ESI) != 0;
    frame.length = std::min<std::uint8_t>(raw.len, frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
    if (!frame.remote) {
        std::copy_n(raw.data, frame.length, frame.data.begin());
    }
}

canfd_frame encode(const Frame& frame) noexcept {
    canfd_frame raw{};
    raw.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0U) | (frame.remote ? CAN_RTR_FLAG : 0U);
    raw.len = frame.length;
    raw.flags = static_cast<std::uint8_t>((frame.bit_rate_switch ? CANFD_BRS : 0) |
                                          (frame.error_state_indicator ? CANFD_ESI : 0));
    if (!frame.remote) {
        std::copy_n(frame.data.begin(), frame.length, raw.data);
    }
    return raw;
}

Origin origin_of(int message_flags) noexcept {
    if ((message_flags & MSG_CONFIRM) != 0) {
        return Origin::this_socket;
    }
    return (message_flags & MSG_DONTROUTE) != 0 ? Origin::this_host : Origin::remote;
}

bool has_more(int descriptor) noexcept {
    pollfd waiting{descriptor, POLLIN, 0};
    return ::poll(&waiting, 1, 0) == 1 && (waiting.revents & POLLIN) != 0;
}

/// What came with a frame, beside its bytes.
struct Ancillary {
    std::int64_t software_ns = 0; ///< 0: none
    std::int64_t hardware_ns = 0; ///< 0: none
    std::uint32_t drops = 0;
    bool has_drops = false;
};

Ancillary ancillary_of(const msghdr& message) noexcept {
    Ancillary out;
    msghdr walked = message; // CMSG_NXTHDR takes a pointer to what it does not change
    for (cmsghdr* item = CMSG_FIRSTHDR(&walked); item != nullptr; item = CMSG_NXTHDR(&walked, item)) {
        if (item->cmsg_level != SOL_SOCKET) {
            continue;
        }
        if (item->cmsg_type == SO_TIMESTAMPING) {
            scm_timestamping stamps{};
            std::memcpy(&stamps, CMSG_DATA(item), sizeof(stamps));
            out.software_ns = nanoseconds(stamps.ts[0]);
            out.hardware_ns = nanoseconds(stamps.ts[2]);
        } else if (item->cmsg_type == SO_RXQ_OVFL) {
            std::memcpy(&out.drops, CMSG_DATA(item), sizeof(out.drops));
            out.has_drops = true;
        }
    }
    return out;
}

} // namespace

SocketCanBus::SocketCanBus(SocketCanOptions options) : options_(std::move(options)) {
    check_name(options_.interface);
    for (const IdFilter& filter : options_.filters) {
        kernel_filters_.push_back(kernel_filter(filter));
    }
    OpenFault fault;
    descriptor_ = open_socket(options_, kernel_filters_, fault);
    if (descriptor_ < 0) {
        throw open_error(options_.interface, fault);
    }
    nothing_waiting();
    if (!is_up(interface_flags(descriptor_, options_.interface))) {
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

/// One read: at most one frame.
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
    decode(raw, static_cast<std::size_t>(size), frame);
    frame.origin = origin_of(message.msg_flags);
    stamp(message, frame);
    ++counters_.received;
    note_error_frame(frame, state_, counters_);
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
    // ENETDOWN, ENODEV, or what no interface that works would say. It comes before frames that still wait.
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

/// The kernel's counter is 32 bits wide and wraps.
void SocketCanBus::count_drops(std::uint32_t total) noexcept {
    counters_.dropped += static_cast<std::uint32_t>(total - kernel_drops_);
    kernel_drops_ = total;
}

void SocketCanBus::go_down() noexcept {
    counters_.interface_down += state_ == BusState::interface_down ? 0 : 1;
    state_ = BusState::interface_down;
}

/// Always a new socket: the old one is bound to an interface that may have gone, and its filters with it.
void SocketCanBus::reopen_if_up() noexcept {
    if (!is_up(interface_flags(descriptor_, options_.interface))) {
        return;
    }
    OpenFault ignored;
    const int descriptor = open_socket(options_, kernel_filters_, ignored);
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
    const canfd_frame raw = encode(frame);
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
