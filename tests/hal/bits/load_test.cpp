// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/bits.hpp"

#include "tests/support/catch.hpp"

#include <array>
#include <limits>

using namespace dfdyn::hal;

TEST_CASE("numbers are decoded from little-endian and big-endian bytes") {
    const std::array<std::uint8_t, 9> bytes{0xAA, 0x01, 0x02, 0x83, 0x04, 0x05, 0x06, 0x07, 0x88};
    const std::uint8_t* odd = bytes.data() + 1; // not aligned
    CHECK(load_little<std::uint16_t>(odd) == 0x0201);
    CHECK(load_big<std::uint16_t>(odd) == 0x0102);
    CHECK(load_little<std::uint32_t>(odd) == 0x04830201);
    CHECK(load_big<std::uint32_t>(odd) == 0x01028304);
    CHECK(load_little<std::uint64_t>(odd) == 0x8807060504830201);
    CHECK(load_big<std::int16_t>(bytes.data() + 3) == -31996);     // 0x8304
    CHECK(load_little<std::int16_t>(bytes.data() + 2) == -0x7CFE); // 0x8302
}

TEST_CASE("IEEE floats are decoded from little-endian and big-endian bytes") {
    const std::array<std::uint8_t, 4> little{0x00, 0x00, 0x20, 0xC0}; // -2.5
    const std::array<std::uint8_t, 4> big{0xC0, 0x20, 0x00, 0x00};
    CHECK(load_little<float>(little.data()) == -2.5F);
    CHECK(load_big<float>(big.data()) == -2.5F);
}

TEST_CASE("stored numbers are decoded unchanged") {
    std::array<std::uint8_t, 6> bytes{1, 1, 1, 1, 1, 1};
    store_big<std::int16_t>(bytes.data() + 1, -2);
    CHECK(bytes == std::array<std::uint8_t, 6>{1, 0xFF, 0xFE, 1, 1, 1});
    store_little<std::int32_t>(bytes.data() + 2, 0x01020304);
    CHECK(bytes == std::array<std::uint8_t, 6>{1, 0xFF, 4, 3, 2, 1});
    store_little<float>(bytes.data(), 1.0F); // 0x3F800000
    CHECK(bytes == std::array<std::uint8_t, 6>{0, 0, 0x80, 0x3F, 2, 1});
}

TEST_CASE("conversion to an integer rounds to nearest and saturates") {
    CHECK(saturated<std::int16_t>(2.5) == 3);
    CHECK(saturated<std::int16_t>(-2.4) == -2);
    CHECK(saturated<std::int16_t>(1e9) == 32767);
    CHECK(saturated<std::int16_t>(-1e300) == -32768);
    CHECK(saturated<std::uint16_t>(-1) == 0);
    CHECK(saturated<std::int32_t>(std::numeric_limits<double>::infinity()) == 2147483647);
    CHECK(saturated<std::int32_t>(std::numeric_limits<double>::quiet_NaN()) == 0);
}
