// SPDX-License-Identifier: Apache-2.0
// Tests that need no CAN support in the kernel; the others are in tests/vcan.
#include "dfdyn/hal/socketcan_bus.hpp"

#include "tests/support/catch.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <string>

#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

using dfdyn::hal::BusError;
using dfdyn::hal::SocketCanBus;

namespace {

/// From now on this process cannot open sockets, as in a container that forbids it.
bool forbid_sockets(int error_number) {
    std::array<sock_filter, 4> program{{
        BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(seccomp_data, nr)),
        BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_socket, 0, 1),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | static_cast<unsigned>(error_number)),
        BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    }};
    const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
    return ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           ::prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

/// Error message of a process that may not open a socket, for this error number.
std::string refusal_without_permission(int error_number) {
    std::array<int, 2> ends{};
    REQUIRE(::pipe(ends.data()) == 0);
    const pid_t child = ::fork();
    REQUIRE(child >= 0);
    if (child == 0) {
        std::string text = "not forbidden";
        if (forbid_sockets(error_number)) {
            try {
                SocketCanBus({.interface = "can0", .filters = {}, .receive_own = false});
            } catch (const BusError& error) {
                text = error.what();
            }
        }
        const auto written = ::write(ends[1], text.data(), text.size());
        ::_exit(written == static_cast<ssize_t>(text.size()) ? 0 : 1);
    }
    std::array<char, 1024> text{};
    ::close(ends[1]);
    const ssize_t length = ::read(ends[0], text.data(), text.size());
    ::close(ends[0]);
    int status = 0;
    ::waitpid(child, &status, 0);
    CHECK(status == 0);
    return {text.data(), static_cast<std::size_t>(std::max<ssize_t>(length, 0))};
}

} // namespace

TEST_CASE("an interface that cannot be opened is rejected in one line with its name") {
    const auto open = [](const std::string& name) {
        SocketCanBus({.interface = name, .filters = {}, .receive_own = false});
    };
    CHECK_THROWS_MATCHES(
        open("no_such_can"), BusError, Catch::Matchers::Predicate<BusError>([](const BusError& error) {
            const std::string text = error.what();
            return text.starts_with("no_such_can: expected ") &&
                   text.find(", found: ") != std::string::npos && text.find('\n') == std::string::npos;
        }));
    CHECK_THROWS_AS(open("a_name_of_16_let"), BusError);
}

TEST_CASE("without permission the error message names the permission that is needed") {
    for (const int error_number : {EPERM, EACCES}) {
        CHECK_THAT(refusal_without_permission(error_number),
                   Catch::Matchers::StartsWith("can0: expected a CAN socket, found: a system that keeps CAN "
                                               "from this program (allow address family AF_CAN"));
    }
}
