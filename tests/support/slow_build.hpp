// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace dfdyn::tests {

/// True if this build checks every access and is about twenty times slower, so that long tests are shortened.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool slow_build = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool slow_build = true;
#else
inline constexpr bool slow_build = false;
#endif
#else
inline constexpr bool slow_build = false;
#endif

} // namespace dfdyn::tests
