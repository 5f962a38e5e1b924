// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dfdyn::tools {

/// Where results go that nobody reads, so that they are computed.
template <class Value>
void keep(const Value& value) {
    asm volatile("" : : "r"(&value) : "memory");
}

} // namespace dfdyn::tools
