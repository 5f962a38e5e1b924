// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/number.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace tools = dfdyn::tools;
using tools::NumberFault;

TEST_CASE("parse_number reads decimal numbers") {
    const auto [text, value] = GENERATE(table<std::string_view, double>(
        {{"0", 0.0}, {"-1.5", -1.5}, {"+2", 2.0}, {"1e-3", 1e-3}, {"1E+3", 1e3}, {".5", 0.5}, {"5.", 5.0}}));
    CAPTURE(text);
    const tools::ParsedNumber number = tools::parse_number(text);
    CHECK(number.fault == NumberFault::none);
    CHECK(number.value == value);
}

TEST_CASE("parse_number reports why it rejects a text") {
    const auto [text, fault] = GENERATE(table<std::string_view, NumberFault>({
        {"", NumberFault::not_a_number},       {"abc", NumberFault::not_a_number},
        {"1.5x", NumberFault::not_a_number},   {"0x1p3", NumberFault::not_a_number},
        {"1,5", NumberFault::not_a_number},    {" 1", NumberFault::not_a_number},
        {"1 ", NumberFault::not_a_number},     {"+-1", NumberFault::not_a_number},
        {"++1", NumberFault::not_a_number},    {"+", NumberFault::not_a_number},
        {"1e", NumberFault::not_a_number},     {"1.5D3", NumberFault::not_a_number},
        {"--1", NumberFault::not_a_number},    {std::string_view("1\0", 2), NumberFault::not_a_number},
        {"nan", NumberFault::out_of_range},    {"-NaN", NumberFault::out_of_range},
        {"inf", NumberFault::out_of_range},    {"-Infinity", NumberFault::out_of_range},
        {"1e999", NumberFault::out_of_range},  {"-1e999", NumberFault::out_of_range},
        {"1e-999", NumberFault::out_of_range},
    }));
    CAPTURE(text);
    CHECK(tools::parse_number(text).fault == fault);
}

TEST_CASE("number_text and parse_number are inverse for every finite double") {
    DFDYN_SEEDED_ENGINE(engine);
    for (int count = 0; count < 10'000; ++count) {
        const auto value = std::bit_cast<double>(engine());
        if (std::isfinite(value)) {
            CAPTURE(value);
            const tools::ParsedNumber number = tools::parse_number(tools::number_text(value));
            REQUIRE(number.fault == NumberFault::none);
            REQUIRE(std::bit_cast<std::uint64_t>(number.value) == std::bit_cast<std::uint64_t>(value));
        }
    }
}

TEST_CASE("number_text writes the shortest form and non-finite numbers as pandas reads them") {
    CHECK(tools::number_text(0.1) == "0.1");
    CHECK(tools::number_text(-2.2250738585072014e-308) == "-2.2250738585072014e-308");
    CHECK(tools::number_text(std::numeric_limits<double>::quiet_NaN()) == "nan");
    CHECK(tools::number_text(-std::numeric_limits<double>::infinity()) == "-inf");
}
