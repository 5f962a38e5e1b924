// SPDX-License-Identifier: Apache-2.0
#pragma once

// Defined in builds with AddressSanitizer, of GCC or Clang.
#if defined(__SANITIZE_ADDRESS__)
#define DFDYN_ADDRESS_SANITIZER 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define DFDYN_ADDRESS_SANITIZER 1
#endif
#endif

namespace dfdyn::tests {

/// True if this build checks every access and is about twenty times slower, so that long tests are shortened.
#ifdef DFDYN_ADDRESS_SANITIZER
inline constexpr bool slow_build = true;
#else
inline constexpr bool slow_build = false;
#endif

} // namespace dfdyn::tests
