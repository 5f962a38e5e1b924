// SPDX-License-Identifier: Apache-2.0
#include "hal/src/can_frame.hpp"

#include <algorithm>
#include <cstring>

#include <linux/errqueue.h>

namespace dfdyn::hal {

void decode_can_frame(const canfd_frame& raw, std::size_t size, Frame& frame) noexcept {
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

canfd_frame encode_can_frame(const Frame& frame) noexcept {
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

Ancillary ancillary_of(const msghdr& message) noexcept {
    Ancillary out;
    msghdr walked = message; // CMSG_NXTHDR takes a non-const pointer but changes nothing
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

} // namespace dfdyn::hal
