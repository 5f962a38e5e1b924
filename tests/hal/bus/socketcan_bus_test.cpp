// SPDX-License-Identifier: Apache-2.0
// What can be tested without CAN in the kernel; the rest is in tests/vcan.
#include "dfdyn/hal/socketcan_bus.hpp"

#include "tests/support/catch.hpp"

using dfdyn::hal::BusError;
using dfdyn::hal::SocketCanBus;

TEST_CASE("an interface that cannot be opened is refused in one line with its name") {
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
