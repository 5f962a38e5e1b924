// SPDX-License-Identifier: Apache-2.0
#pragma once

// The one Catch2 header that tests include: version 2 or 3, whichever is installed, spelt the same way in
// both: `Approx`, and matchers as `Catch::Matchers::...`.

#if __has_include(<catch2/catch_all.hpp>)
#include <catch2/catch_all.hpp>

using Catch::Approx;
#else
#include <catch2/catch.hpp>

#include <string>

namespace Catch::Matchers {

/// Version 3's name of the matcher that version 2 calls Contains.
// NOLINTNEXTLINE(readability-identifier-naming)
inline StdString::ContainsMatcher ContainsSubstring(const std::string& text) { return Contains(text); }

} // namespace Catch::Matchers
#endif
