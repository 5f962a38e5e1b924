// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tests/support/catch.hpp"

#include <cstdint>
#include <cstdlib>
#include <random>
#include <string>

namespace dfdyn::tests {

/// The seed of random tests: the environment variable DFDYN_TEST_SEED, or 1.
inline std::uint64_t seed() {
    const char* const text = std::getenv("DFDYN_TEST_SEED");
    return text == nullptr ? 1 : std::stoull(text);
}

} // namespace dfdyn::tests

/// Defines `name`, a std::mt19937_64 from the seed; a check that fails in its scope prints the seed. A macro,
/// because Catch2 forgets a message at the end of the scope it was made in.
#define DFDYN_SEEDED_ENGINE(name)                                                                            \
    INFO("DFDYN_TEST_SEED=" << dfdyn::tests::seed());                                                        \
    std::mt19937_64 name(dfdyn::tests::seed())
