// SPDX-License-Identifier: Apache-2.0
#include "embedding.hpp"

#include <dfdyn/hal/socketcan_bus.hpp>
#include <tools/build_flags.hpp>

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

} // namespace

int main() {
    return dfdyn::tools::build_flags().empty() || !refuses_a_bus_that_is_not_there() ? 1 : run_example();
}
