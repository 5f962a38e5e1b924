// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dfdyn::tools {

/// Marks an unused result as used, so that the compiler computes it.
template <class Value>
void keep(const Value& value) {
    asm volatile("" : : "r"(&value) : "memory");
}

} // namespace dfdyn::tools
