// SPDX-License-Identifier: Apache-2.0
#pragma once

// The only Catch2 header that tests include. It supports versions 2 and 3 with the same names: `Approx`, and
// matchers as `Catch::Matchers::...`.

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>

using Catch::Approx;
#else
#include <catch2/catch.hpp>

#include <string>

namespace Catch::Matchers {

/// Name in version 3 of the matcher that version 2 calls Contains.
// NOLINTNEXTLINE(readability-identifier-naming)
inline StdString::ContainsMatcher ContainsSubstring(const std::string& text) { return Contains(text); }

} // namespace Catch::Matchers
#endif
