// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/bits.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <vector>

using namespace dfdyn::hal;

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr auto signed_integer = Encoding::signed_integer;
constexpr auto unsigned_integer = Encoding::unsigned_integer;
constexpr auto intel = ByteOrder::intel;
constexpr auto motorola = ByteOrder::motorola;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Reference: the positions of a signal's bits in the data, from the lowest bit to the highest.
std::vector<int> places_of(const Signal& signal) {
    std::vector<int> places;
    int bit = signal.start_bit;
    for (int i = 0; i < signal.length; ++i) {
        if (signal.byte_order == intel) {
            places.push_back(bit++);
        } else {
            places.insert(places.begin(), bit);
            bit = bit % 8 == 0 ? bit + 15 : bit - 1;
        }
    }
    return places;
}

bool bit_of(const Bytes& data, int place) {
    return (data[static_cast<std::size_t>(place / 8)] >> (place % 8) & 1) != 0;
}

/// Reference: the physical value, exact for integers of up to 53 bits.
double reference_value(const Signal& signal, const Bytes& data) {
    const std::vector<int> places = places_of(signal);
    double value = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
        const bool negative = signal.encoding == signed_integer && i + 1 == places.size();
        const double weight = std::ldexp(negative ? -1.0 : 1.0, static_cast<int>(i));
        value += bit_of(data, places[i]) ? weight : 0;
    }
    return signal.factor * value + signal.offset;
}

bool reference_fits(const Signal& signal, int bytes) {
    for (const int place : places_of(signal)) {
        if (place < 0 || place / 8 >= bytes) {
            return false;
        }
    }
    return true;
}

int between(std::mt19937_64& engine, int lowest, int highest) {
    return std::uniform_int_distribution<int>(lowest, highest)(engine);
}

Bytes random_bytes(std::mt19937_64& engine, int count) {
    Bytes data(static_cast<std::size_t>(count));
    for (std::uint8_t& byte : data) {
        byte = static_cast<std::uint8_t>(between(engine, 0, 255));
    }
    return data;
}

Signal random_signal(std::mt19937_64& engine, int bytes, int longest) {
    Signal signal;
    do {
        signal.byte_order = between(engine, 0, 1) == 0 ? intel : motorola;
        signal.encoding = between(engine, 0, 1) == 0 ? unsigned_integer : signed_integer;
        signal.length = between(engine, 1, std::min(longest, 8 * bytes));
        signal.start_bit = between(engine, 0, 8 * bytes - 1);
    } while (!reference_fits(signal, bytes));
    return signal;
}

} // namespace

TEST_CASE("signals of known frames have their known values") {
    const Bytes data{0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0xDE, 0xF0};
    CHECK(Signal{0, 16, intel}.extract_raw(data) == 0x3412);
    CHECK(Signal{7, 16, motorola}.extract_raw(data) == 0x1234);
    // nibbles 3 4 of byte 1, then 1, the high nibble of byte 0
    CHECK(Signal{4, 12, intel}.extract_raw(data) == 0x341);
    CHECK(Signal{3, 12, motorola}.extract_raw(data) == 0x234); // low nibble of byte 0, then byte 1
    CHECK(Signal{8, 3, intel}.extract_raw(data) == 0b100);
    CHECK(Signal{13, 3, motorola}.extract_raw(data) == 0b110); // bits 5..3 of 0x34
    CHECK(Signal{0, 64, intel}.extract_raw(data) == 0xF0DEBC9A78563412);
    CHECK(Signal{7, 64, motorola}.extract_raw(data) == 0x123456789ABCDEF0);
    CHECK(Signal{32, 8, intel, signed_integer}.extract(data) == -102);       // 0x9A
    CHECK(Signal{39, 16, motorola, signed_integer}.extract(data) == -25924); // 0x9ABC
    CHECK(Signal{32, 16, intel, unsigned_integer, 0.5, -10}.extract(data) == 0.5 * 0xBC9A - 10);
    CHECK(Signal{47, 1, intel, signed_integer}.extract(data) == -1); // a signed bit
}

TEST_CASE("float signals are decoded and encoded") {
    const Bytes data{0x00, 0x00, 0x20, 0xC0, 0xC0, 0x20, 0x00, 0x00};
    CHECK(Signal{0, 32, intel, Encoding::float32, 2, 1}.extract(data) == -4);
    CHECK(Signal{39, 32, motorola, Encoding::float32}.extract(data) == -2.5);
    const Bytes one_and_a_half{0, 0, 0, 0, 0, 0, 0xF8, 0x3F};
    CHECK(Signal{0, 64, intel, Encoding::float64}.extract(one_and_a_half) == 1.5);
    Bytes into(8);
    Signal{0, 32, intel, Encoding::float32}.insert(into, 1e300);
    CHECK(Signal{0, 32, intel, Encoding::float32}.extract(into) ==
          static_cast<double>(std::numeric_limits<float>::max()));
    Signal{0, 32, intel, Encoding::float32}.insert(into, -infinity);
    CHECK(Signal{0, 32, intel, Encoding::float32}.extract(into) == -infinity);
}

TEST_CASE("a signal fits if and only if all its bits are in the data") {
    CHECK(Signal{0, 64, intel}.fits(8));
    CHECK_FALSE(Signal{1, 64, intel}.fits(8));
    CHECK_FALSE(Signal{6, 64, motorola}.fits(8));
    CHECK_FALSE(Signal{0, 0, intel}.fits(8));
    CHECK_FALSE(Signal{0, 65, intel}.fits(64));
    CHECK_FALSE(Signal{-1, 4, intel}.fits(8));
    CHECK_FALSE(Signal{0, 16, intel, Encoding::float32}.fits(8));
    CHECK_FALSE(Signal{0, 32, intel, Encoding::float64}.fits(8));
    DFDYN_SEEDED_ENGINE(engine);
    for (int i = 0; i < 20000; ++i) {
        const Signal signal{between(engine, 0, 70), between(engine, 1, 64),
                            between(engine, 0, 1) == 0 ? intel : motorola};
        const int bytes = between(engine, 0, 9);
        REQUIRE(signal.fits(bytes) == reference_fits(signal, bytes));
    }
}

TEST_CASE("random signals equal a bit-by-bit reference") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int i = 0; i < 20000; ++i) {
        const int bytes = between(engine, 0, 9) == 0 ? 64 : 8;
        Signal signal = random_signal(engine, bytes, 53);
        signal.factor = 0.25;
        signal.offset = -3;
        const Bytes data = random_bytes(engine, bytes);
        INFO("start " << signal.start_bit << ", length " << signal.length);
        REQUIRE(signal.extract(data) == reference_value(signal, data));
    }
}

TEST_CASE("inserting a signal changes no other bits") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int i = 0; i < 20000; ++i) {
        const Signal signal = random_signal(engine, 8, 64);
        const Bytes before = random_bytes(engine, 8);
        const std::uint64_t raw = engine();
        Bytes after = before;
        signal.insert_raw(after, raw);
        std::vector<int> places = places_of(signal);
        for (int place = 0; place < 64; ++place) {
            const auto found = std::find(places.begin(), places.end(), place);
            const bool expected =
                found == places.end() ? bit_of(before, place) : (raw >> (found - places.begin()) & 1) != 0;
            REQUIRE(bit_of(after, place) == expected);
        }
        REQUIRE(signal.extract_raw(after) ==
                (signal.length == 64 ? raw : raw & ((1ULL << signal.length) - 1)));
    }
}

TEST_CASE("encoding and decoding a physical value changes it by at most half a step") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int i = 0; i < 20000; ++i) {
        Signal signal = random_signal(engine, 8, 52);
        signal.factor = std::uniform_real_distribution<double>(0.001, 2)(engine);
        signal.offset = between(engine, -1000, 1000);
        Bytes data = random_bytes(engine, 8);
        // a value that the signal represents exactly
        const double value = signal.extract(random_bytes(engine, 8));
        signal.insert(data, value + 0.4 * signal.factor);
        REQUIRE(signal.extract(data) == Approx(value).margin(1e-9 * std::abs(value) + 1e-9));
    }
}

TEST_CASE("values beyond a signal's range are clamped") {
    for (const ByteOrder order : {intel, motorola}) {
        for (const int length : {1, 2, 7, 8, 12, 16, 31, 32, 33, 63, 64}) {
            const int start = order == intel ? 0 : 7;
            Bytes data(8);
            const Signal plain{start, length, order};
            plain.insert(data, 1e300);
            CHECK(plain.extract_raw(data) == ~0ULL >> (64 - length));
            plain.insert(data, -1);
            CHECK(plain.extract_raw(data) == 0);
            const Signal with_sign{start, length, order, signed_integer};
            with_sign.insert(data, infinity);
            CHECK(with_sign.extract_raw(data) == ~0ULL >> (64 - length) >> 1);
            with_sign.insert(data, -infinity);
            CHECK(with_sign.extract_raw(data) == 1ULL << (length - 1));
            with_sign.insert(data, std::numeric_limits<double>::quiet_NaN());
            CHECK(with_sign.extract_raw(data) == 0);
        }
    }
}
