// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/hal/assembly/sampler.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <vector>

namespace sampler_test {

using namespace dfdyn::hal;

constexpr std::int64_t ms = 1'000'000;
constexpr std::int64_t start = 100 * ms;

/// An arm with values for times before `known_ns` and from `known_again_ns` on. Its other values are missing
/// for at most `patience_ns`. A frame with identifier 0x80 is a trigger, with the time of the frame before.
struct ScriptedArm {
    std::int64_t known_ns = std::numeric_limits<std::int64_t>::max();
    std::int64_t known_again_ns = std::numeric_limits<std::int64_t>::max();
    std::int64_t patience_ns = 0;
    std::int64_t moment_ns = 0;
    int updates = 0;
    std::vector<std::int64_t> taken_ns; ///< times at which frames were taken

    std::optional<std::int64_t> take(const Frame& frame, std::int64_t now_ns) {
        taken_ns.push_back(now_ns);
        if (frame.id != 0x80) {
            return std::nullopt;
        }
        const std::int64_t before_ns = moment_ns;
        moment_ns = frame.stamp_ns;
        return before_ns == 0 ? std::nullopt : std::optional(before_ns);
    }
    void update(BusState /*state*/, const BusCounters& /*counters*/) { ++updates; }
    bool pending(std::int64_t instant_ns, std::int64_t now_ns) const {
        return instant_ns >= known_ns && instant_ns < known_again_ns && now_ns - instant_ns <= patience_ns;
    }
    std::int64_t assemble(std::int64_t instant_ns, std::int64_t /*now_ns*/) { return instant_ns; }
};

/// A sampler, its arm, and the sample times and assembly times.
template <std::size_t capacity = 16>
struct Bench {
    explicit Bench(const SamplerConfig& config) : sampler(config) {}

    void frame(std::int64_t stamp_ns, std::uint32_t id = 0x100) {
        Frame frame;
        frame.id = id;
        frame.stamp_ns = stamp_ns;
        sampler.take(arm, frame, BusState::active, {}, recorder());
    }
    void frames(std::int64_t from_ns, std::int64_t to_ns, std::int64_t step_ns, std::uint32_t id = 0x100) {
        for (; from_ns <= to_ns; from_ns += step_ns) {
            frame(from_ns, id);
        }
    }
    auto recorder() {
        return [this](std::int64_t instant_ns, std::int64_t now_ns) {
            instants.push_back(instant_ns);
            times.push_back(now_ns);
        };
    }

    ScriptedArm arm;
    Sampler<ScriptedArm, capacity> sampler;
    std::vector<std::int64_t> instants, times;
};

const SamplerConfig timer{.timer = true, .period_ns = 2 * ms, .delay_ns = 3 * ms, .patience_ns = 6 * ms};
const SamplerConfig moments{.timer = false, .period_ns = 2 * ms, .delay_ns = 0, .patience_ns = 6 * ms};

TEST_CASE("a timer's samples come every period, with a constant delay") {
    Bench bench(timer);
    bench.frames(start, start + 10 * ms, ms);
    CHECK(bench.times == std::vector{start + 2 * ms, start + 4 * ms, start + 6 * ms, start + 8 * ms});
    CHECK(bench.instants == std::vector{start - ms, start + ms, start + 3 * ms, start + 5 * ms});
    bench.sampler.advance_to(bench.arm, start + 10 * ms, bench.recorder());
    CHECK(bench.times.back() == start + 10 * ms); // no frame of that time can come any more
}

TEST_CASE("triggered samples have their own times; without triggers, samples are periodic") {
    Bench bench(moments);
    for (int cycle = 0; cycle < 4; ++cycle) {
        bench.frame(start + 2 * cycle * ms, 0x80);
    }
    CHECK(bench.instants == std::vector{start, start + 2 * ms, start + 4 * ms});
    bench.frames(start + 7 * ms, start + 20 * ms, ms);
    const std::vector<std::int64_t> late(bench.times.begin() + 3, bench.times.end());
    CHECK(late ==
          std::vector{start + 12 * ms, start + 14 * ms, start + 16 * ms, start + 18 * ms}); // after 6 ms
}

TEST_CASE("a trigger from before a silence makes no sample after those of the silence") {
    Bench bench(moments);
    bench.frame(start, 0x80);
    bench.frame(start + 2 * ms, 0x80);
    bench.frames(start + 400 * ms, start + 402 * ms, ms); // no triggers
    bench.frame(start + 403 * ms, 0x80);                  // completes the sample of 2 ms
    CHECK(std::is_sorted(bench.instants.begin(), bench.instants.end()));
    CHECK(bench.sampler.late_moments() == 1);
    bench.frame(start + 405 * ms, 0x80);
    CHECK(bench.instants.back() == start + 403 * ms);
}

TEST_CASE("triggers further apart than the patience make their samples in order of time") {
    for (const std::int64_t apart_ns : {13 * ms / 2, 7 * ms, 8 * ms, 10 * ms, 100 * ms, 700 * ms}) {
        CAPTURE(apart_ns);
        Bench bench(moments);
        bench.frames(start - 20 * ms, start - 2 * ms, 2 * ms, 0x80); // faster at first
        std::vector<std::int64_t> missed;
        constexpr int many = 1000;
        for (int i = 0; i < many; ++i) {
            bench.frame(start + i * apart_ns, 0x80);
        }
        bench.sampler.finish(bench.arm, bench.recorder());
        for (int i = 0; i < many - 1; ++i) {
            const std::int64_t instant_ns = start + i * apart_ns;
            if (!std::binary_search(bench.instants.begin(), bench.instants.end(), instant_ns)) {
                missed.push_back(i);
            }
        }
        CHECK(missed.size() <= 1); // at the change of the period
        CHECK(bench.sampler.late_moments() <= 1);
        CHECK(std::adjacent_find(bench.instants.begin(), bench.instants.end(), std::greater_equal<>()) ==
              bench.instants.end());
    }
}

TEST_CASE("a sample waits for a missing value, and later samples wait in order") {
    Bench bench(timer);
    bench.arm.patience_ns = 20 * ms;
    bench.arm.known_ns = start + 2 * ms;
    bench.frames(start, start + 9 * ms, ms);
    CHECK(bench.instants == std::vector{start - ms, start + ms});
    bench.arm.known_ns = start + 4 * ms; // the value of 3 ms has come
    bench.frame(start + 9 * ms + ms / 2);
    CHECK(bench.instants == std::vector{start - ms, start + ms, start + 3 * ms});
    CHECK(bench.times.back() == start + 9 * ms + ms / 2);
    bench.sampler.finish(bench.arm, bench.recorder()); // which does not wait
    CHECK(bench.instants == std::vector{start - ms, start + ms, start + 3 * ms, start + 5 * ms});
}

TEST_CASE("a sample stops waiting when its value can no longer come") {
    Bench bench(timer);
    bench.arm.known_ns = start + 2 * ms;
    bench.arm.patience_ns = 5 * ms;
    bench.frames(start, start + 7 * ms, ms);
    CHECK(bench.instants == std::vector{start - ms, start + ms});
    bench.frames(start + 8 * ms, start + 9 * ms, ms);
    CHECK(bench.instants == std::vector{start - ms, start + ms, start + 3 * ms}); // 5 ms later the wait ends
}

TEST_CASE("a complete sample does not overtake a waiting one") {
    Bench bench(timer);
    bench.arm.patience_ns = 20 * ms;
    bench.arm.known_ns = start + 2 * ms;
    bench.arm.known_again_ns = start + 4 * ms; // missing from 3 ms on
    bench.frames(start, start + 9 * ms, ms);
    CHECK(bench.instants == std::vector{start - ms, start + ms});
    bench.arm.known_ns = start + 4 * ms;
    bench.frame(start + 10 * ms);
    CHECK(bench.instants == std::vector{start - ms, start + ms, start + 3 * ms, start + 5 * ms});
}

TEST_CASE("the number of waiting samples is bounded") {
    Bench<2> bench(timer);
    bench.arm.patience_ns = 1000 * ms;
    bench.arm.known_ns = start;
    bench.frames(start, start + 9 * ms, ms);
    CHECK(bench.instants == std::vector{start - ms, start + ms}); // those of 3 and 5 ms wait
    CHECK(bench.times.back() == start + 8 * ms);
}

TEST_CASE("a frame with a stamp ahead is dropped if the next stamp does not continue from it") {
    Bench bench(timer);
    bench.frames(start, start + 4 * ms, ms);
    bench.frame(start + 700 * ms);
    bench.frame(start + 5 * ms);
    CHECK(bench.sampler.strays() == 1);
    CHECK(bench.arm.taken_ns.size() == 6);
    CHECK(bench.sampler.now_ns() == start + 5 * ms);
    CHECK(bench.times == std::vector{start + 2 * ms, start + 4 * ms});
}

TEST_CASE("up to three consecutive frames with stamps ahead are dropped") {
    for (int ahead = 1; ahead <= static_cast<int>(Sampler<ScriptedArm>::most_strays); ++ahead) {
        CAPTURE(ahead);
        Bench bench(timer);
        bench.frames(start, start + 4 * ms, ms);
        bench.frames(start + 40 * ms, start + (39 + ahead) * ms, ms);
        bench.frames(start + 5 * ms, start + 8 * ms, ms);
        CHECK(bench.sampler.strays() == static_cast<std::uint64_t>(ahead));
        CHECK(bench.arm.taken_ns.size() == 9);
        CHECK(bench.sampler.now_ns() == start + 8 * ms);
    }
}

TEST_CASE("a frame with a stamp ahead is taken if the next three stamps continue from it") {
    Bench bench(timer);
    bench.frames(start, start + 4 * ms, ms);
    bench.frames(start + 700 * ms, start + 702 * ms, ms);
    CHECK(bench.arm.taken_ns.size() == 5); // held
    bench.frame(start + 703 * ms);
    CHECK(bench.sampler.strays() == 0);
    CHECK(bench.arm.taken_ns.size() == 9);
    CHECK(bench.arm.taken_ns[5] == start + 700 * ms);
    CHECK(bench.arm.updates == 9);
}

TEST_CASE("frames in bursts are taken at once, and rare frames with the next one") {
    for (const std::int64_t apart_ns : {6 * ms, 10 * ms, 90 * ms, 110 * ms, 300 * ms}) {
        for (const int burst : {1, 2, 3, 4}) {
            CAPTURE(apart_ns, burst);
            Bench bench(timer);
            for (int i = 0; i < 20; ++i) {
                for (int k = 0; k < burst; ++k) {
                    bench.frame(start + i * apart_ns + k * ms / 4);
                }
                CHECK(bench.arm.taken_ns.size() >= static_cast<std::size_t>(i * burst)); // all earlier ones
            }
            bench.sampler.finish(bench.arm, bench.recorder());
            CHECK(bench.sampler.strays() == 0);
            CHECK(bench.arm.taken_ns.size() == static_cast<std::size_t>(20 * burst));
        }
    }
}

TEST_CASE("if time returns to between held frames, only those ahead of it are dropped") {
    Bench bench(timer);
    bench.frames(start, start + 4 * ms, ms);
    bench.frame(start + 20 * ms);
    bench.frame(start + 25 * ms);
    bench.frame(start + 30 * ms); // ahead of the next
    bench.frame(start + 21 * ms);
    CHECK(bench.sampler.strays() == 1);
    CHECK(bench.arm.taken_ns.back() == start + 25 * ms); // overtaken by the frame of that time
}

TEST_CASE("a bus that reports the time between frames gives the samples of its recording") {
    DFDYN_SEEDED_ENGINE(engine);
    const auto draw = [&](std::int64_t from, std::int64_t to) {
        return std::uniform_int_distribution<std::int64_t>(from, to)(engine);
    };
    std::uint64_t strays = 0;
    for (int round = 0; round < 200; ++round) {
        Bench live(timer);
        Bench replayed(timer);
        std::int64_t time_ns = start;
        std::int64_t ahead_ns = 0;
        std::int64_t left = 0; ///< wrong stamps in a row
        for (int i = 0; i < 200; ++i) {
            const std::int64_t step_ns = draw(0, 9) == 0 ? draw(6, 300) * ms : draw(50, 1000) * 1000;
            if (--left <= 0) {
                left = draw(1, Sampler<ScriptedArm>::most_strays);
                ahead_ns = ahead_ns == 0 && i > 0 && draw(0, 3) == 0 ? draw(400, 700) * ms : 0;
            }
            if (i > 0) {
                live.sampler.advance_to(live.arm, draw(time_ns, time_ns + step_ns - 1), live.recorder());
            }
            time_ns += step_ns;
            live.frame(time_ns + ahead_ns);
            replayed.frame(time_ns + ahead_ns);
        }
        live.sampler.finish(live.arm, live.recorder());
        replayed.sampler.finish(replayed.arm, replayed.recorder());
        REQUIRE(live.instants == replayed.instants);
        REQUIRE(live.times == replayed.times);
        REQUIRE(live.arm.taken_ns == replayed.arm.taken_ns);
        REQUIRE(live.sampler.strays() == replayed.sampler.strays());
        strays += live.sampler.strays();
    }
    CHECK(strays > 100);
}

TEST_CASE("a long silence makes samples for one second only") {
    Bench bench(timer);
    bench.frames(start, start + 4 * ms, ms);
    bench.frame(start + 5000 * ms);
    bench.frames(start + 5001 * ms, start + 5003 * ms, ms);
    const auto count = bench.instants.size();
    CHECK(count >= 500);
    CHECK(count <= 504);
    bench.frame(start + 5005 * ms);
    CHECK(bench.times.back() > start + 5000 * ms); // periodic again from there on
    CHECK(bench.instants.size() - count == 1);
}

TEST_CASE("stamps at both ends of the integer range keep the samples periodic") {
    constexpr std::int64_t first = std::numeric_limits<std::int64_t>::min() + 1000 * ms;
    constexpr std::int64_t last = std::numeric_limits<std::int64_t>::max() - 10'000 * ms;
    Bench bench(timer);
    bench.frames(first, first + 4 * ms, ms);
    bench.frame(last);
    const auto count = bench.times.size();
    bench.frames(last + ms, last + 10 * ms, ms);
    CHECK(count <= 502); // samples of one second
    CHECK(bench.times.size() - count == 5);
    CHECK(std::is_sorted(bench.times.begin(), bench.times.end()));
}

} // namespace sampler_test
