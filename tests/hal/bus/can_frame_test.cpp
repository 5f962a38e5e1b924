// SPDX-License-Identifier: Apache-2.0
#include "hal/src/can_frame.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/random_frame.hpp"
#include "tests/support/same_frame.hpp"
#include "tests/support/seed.hpp"

#include <array>
#include <cstring>

#include <linux/errqueue.h>

namespace {

using dfdyn::hal::Ancillary;
using dfdyn::hal::Frame;

/// A message with ancillary data in the kernel's layout.
class Message {
  public:
    template <class Value>
    void add(int type, const Value& value) {
        message_.msg_control = control_.data();
        message_.msg_controllen = used_ + CMSG_SPACE(sizeof(Value));
        cmsghdr item{};
        item.cmsg_level = SOL_SOCKET;
        item.cmsg_type = type;
        item.cmsg_len = CMSG_LEN(sizeof(Value));
        std::memcpy(control_.data() + used_, &item, sizeof(item));
        std::memcpy(control_.data() + used_ + CMSG_LEN(0), &value, sizeof(value));
        used_ = message_.msg_controllen;
    }

    Ancillary read() const { return dfdyn::hal::ancillary_of(message_); }

  private:
    alignas(cmsghdr) std::array<char, 256> control_{};
    std::size_t used_ = 0;
    msghdr message_{};
};

scm_timestamping stamps(timespec software, timespec hardware) {
    scm_timestamping out{};
    out.ts[0] = software;
    out.ts[2] = hardware;
    return out;
}

} // namespace

TEST_CASE("time stamps and drop counts are read from ancillary data") {
    const Ancillary nothing = Message().read();
    CHECK(nothing.software_ns == 0);
    CHECK(nothing.hardware_ns == 0);
    CHECK_FALSE(nothing.has_drops);

    Message message;
    message.add(SO_TIMESTAMPING, stamps({5, 6}, {7, 8}));
    message.add(SO_RXQ_OVFL, std::uint32_t{4'000'000'000});
    const Ancillary both = message.read();
    CHECK(both.software_ns == 5'000'000'006);
    CHECK(both.hardware_ns == 7'000'000'008);
    CHECK(both.has_drops);
    CHECK(both.drops == 4'000'000'000);

    Message other;
    other.add(SO_RXQ_OVFL, std::uint32_t{0});
    CHECK(other.read().has_drops);
    CHECK(other.read().software_ns == 0);
}

TEST_CASE("random frames are unchanged after conversion to the kernel's layout and back") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int round = 0; round < 5'000; ++round) {
        const Frame frame = dfdyn::tests::random_frame(engine);
        if (frame.error) {
            continue; // error frames can only be received
        }
        Frame read;
        dfdyn::hal::decode_can_frame(dfdyn::hal::encode_can_frame(frame), frame.fd ? CANFD_MTU : CAN_MTU,
                                     read);
        read.stamp_ns = frame.stamp_ns;
        read.stamp_source = frame.stamp_source;
        read.origin = frame.origin;
        REQUIRE(dfdyn::tests::same(read, frame));
    }
}

TEST_CASE("a length above the maximum is clamped") {
    canfd_frame raw{};
    raw.len = 200;
    Frame classic;
    dfdyn::hal::decode_can_frame(raw, CAN_MTU, classic);
    CHECK(classic.length == 8);
    Frame fd;
    dfdyn::hal::decode_can_frame(raw, CANFD_MTU, fd);
    CHECK(fd.length == 64);
}
