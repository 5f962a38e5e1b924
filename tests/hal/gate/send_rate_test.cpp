// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/gate/send_rate.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <random>
#include <vector>

namespace send_rate_test {

using dfdyn::hal::SendRateGate;

constexpr std::int64_t us = 1000;
constexpr std::int64_t period_ns = 1000 * us;

std::int64_t between(std::mt19937_64& engine, std::int64_t lowest, std::int64_t highest) {
    return std::uniform_int_distribution<std::int64_t>(lowest, highest)(engine);
}

TEST_CASE("one sender is never suspected for any delays, and its earliest send time is true") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const std::int64_t delay_ns : {0 * us, 130 * us, 500 * us, 780 * us, 990 * us}) {
        for (const double clock : {0.98, 0.993, 1.0, 1.0001, 1.3, 7.7}) { // fast, exact, slow, on demand
            SendRateGate gate(
                {.period_ns = period_ns, .delay_ns = delay_ns, .clock_tolerance = clock < 0.99 ? 40 : 128});
            std::int64_t sent_ns = 5'000'000'000;
            int suspected = 0;
            int contradicted = 0;
            for (int frame = 0; frame < 20'000; ++frame) {
                suspected += gate.too_soon(sent_ns + between(engine, 0, delay_ns)) ? 1 : 0;
                sent_ns += static_cast<std::int64_t>(clock * period_ns) * (frame % 100 == 99 ? 5 : 1);
                contradicted += gate.could_have_sent_again_by(sent_ns) ? 0 : 1;
            }
            CHECK(suspected == 0);
            CHECK(contradicted == 0);
        }
    }
}

TEST_CASE("two senders are detected within three periods, for any offset") {
    DFDYN_SEEDED_ENGINE(engine);
    for (const std::int64_t delay_ns : {130 * us, 500 * us, 780 * us}) {
        for (const std::int64_t offset_ns : {60 * us, 300 * us, 500 * us, 800 * us, 940 * us}) {
            std::vector<std::int64_t> stamps;
            for (std::int64_t k = 0; k < 2000; ++k) {
                stamps.push_back(k * period_ns + between(engine, 0, delay_ns));
                stamps.push_back(k * period_ns + offset_ns + between(engine, 0, delay_ns));
            }
            std::ranges::sort(stamps);
            SendRateGate gate({.period_ns = period_ns, .delay_ns = delay_ns});
            int unseen = 0;
            int longest = 0;
            for (const std::int64_t stamp : stamps) {
                unseen = gate.too_soon(stamp) ? 0 : unseen + 1;
                longest = std::max(longest, unseen);
            }
            CAPTURE(delay_ns, offset_ns);
            CHECK(longest <= 6);
        }
    }
}

TEST_CASE("with short delays, a second sender is detected at its first frame") {
    for (const std::int64_t offset_ns : {60 * us, 500 * us, 700 * us}) {
        SendRateGate gate({.period_ns = period_ns, .delay_ns = 200 * us});
        for (std::int64_t k = 0; k < 10; ++k) {
            CHECK_FALSE(gate.too_soon(k * period_ns));
        }
        CHECK(gate.too_soon(9 * period_ns + offset_ns));
    }
}

TEST_CASE("frames with a repeated or an older stamp are no evidence") {
    SendRateGate gate({.period_ns = period_ns, .delay_ns = 200 * us});
    for (int frame = 0; frame < 10; ++frame) {
        CHECK_FALSE(gate.too_soon(10 * period_ns));
    }
    CHECK_FALSE(gate.too_soon(7 * period_ns));
    CHECK_FALSE(gate.too_soon(11 * period_ns));
}

} // namespace send_rate_test
