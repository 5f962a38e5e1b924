// SPDX-License-Identifier: Apache-2.0
#include "hal/src/can_socket.hpp"

#include <bit>
#include <cerrno>
#include <system_error>

#include <linux/can.h>
#include <linux/can/raw.h>
#include <linux/net_tstamp.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace dfdyn::hal {
namespace {

static_assert(sizeof(can_filter) == sizeof(std::uint64_t));

template <class Value>
bool set_option(int descriptor, int level, int name, const Value& value) noexcept {
    return ::setsockopt(descriptor, level, name, &value, sizeof(value)) == 0;
}

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

} // namespace

std::uint64_t kernel_filter(const IdFilter& filter) noexcept {
    can_filter out{};
    out.can_id = filter.id | (filter.extended ? CAN_EFF_FLAG : 0U);
    out.can_mask = filter.mask | CAN_EFF_FLAG;
    return std::bit_cast<std::uint64_t>(out);
}

int open_can_socket(const SocketCanOptions& options, std::span<const std::uint64_t> filters,
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
    } else if (address.can_ifindex == 0) { // bound to 0, the socket would receive from every interface
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
    } else if (fault.error_number == EPERM || fault.error_number == EACCES) {
        found =
            "a system that keeps CAN from this program (allow address family AF_CAN in the container's or "
            "service's rules: seccomp, AppArmor, SELinux): " +
            found;
    } else if (fault.error_number == ENODEV && ::if_nametoindex(interface.c_str()) != 0) {
        found = "an interface of another kind";
    }
    return BusError(interface + ": expected " + fault.expected + ", found: " + found);
}

bool interface_is_up(int descriptor, const std::string& interface) noexcept {
    ifreq request{};
    interface.copy(request.ifr_name, IFNAMSIZ - 1);
    return ::ioctl(descriptor, SIOCGIFFLAGS, &request) == 0 && (request.ifr_flags & IFF_UP) != 0;
}

} // namespace dfdyn::hal
