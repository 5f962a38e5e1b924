// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "semihosting.hpp"

#include <cstdint>

inline void report(const char* what, std::uint32_t number, const char* unit) {
    semihosting::write(what);
    semihosting::write(number);
    semihosting::write(unit);
}
