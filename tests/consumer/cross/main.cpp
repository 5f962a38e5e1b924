// SPDX-License-Identifier: Apache-2.0
#include "embedding.hpp"

#include <dfdyn/hal/device/cia402.hpp>

int run() { return run_example(); }
