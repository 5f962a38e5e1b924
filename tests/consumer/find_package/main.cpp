// SPDX-License-Identifier: Apache-2.0
#include "embedding.hpp"

#include <dfdyn/eigen.hpp>
#include <dfdyn/hal/socketcan_bus.hpp>

namespace {

/// Whether the compiled part of the bus layer is there.
bool refuses_a_bus_that_is_not_there() {
    try {
        const dfdyn::hal::SocketCanBus bus({.interface = "no_such_can", .filters = {}, .receive_own = false});
        return false;
    } catch (const dfdyn::hal::BusError&) {
        return true;
    }
}

bool views_do_not_copy() {
    dfdyn::Storage<float, 3> numbers{};
    dfdyn::view(numbers).setConstant(2);
    return numbers[2] == 2;
}

} // namespace

int main() { return views_do_not_copy() && refuses_a_bus_that_is_not_there() ? run_example() : 1; }
