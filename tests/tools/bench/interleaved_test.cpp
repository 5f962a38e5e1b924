// SPDX-License-Identifier: Apache-2.0
// The order and the counts of measurements. No times are checked.
#include "dfdyn/core/vector.hpp"
#include "tools/bench/timing/interleaved.hpp"
#include "tools/bench/timing/machine_lower_bound.hpp"

#include "tests/support/catch.hpp"

#include <string>

using namespace dfdyn::tools;

namespace {

class Noting final : public Ticking {
  public:
    Noting(std::string& notes, char name) : notes_(notes), name_(name) {}
    void tick() override { notes_ += name_; }

  private:
    std::string& notes_;
    char name_;
};

} // namespace

TEST_CASE("subjects alternate and the first two ticks of each turn do not count") {
    std::string notes;
    Noting a(notes, 'a');
    Noting b(notes, 'b');
    Ticking* const subjects[] = {&a, &b};
    MultiplyAddProbe probe;
    const RepetitionOptions options{.passes = 3, .repetition_us = 0, .fewest_ticks = 2, .undisturbed = 0};
    int passes = 0;
    const auto times = time_interleaved(subjects, options, probe, 0, [&](int done) { passes = done; });
    CHECK(notes == "aaaabbbbaaaabbbbaaaabbbb");
    CHECK(passes == 3);
    REQUIRE(times.size() == 2);
    for (const TickTimes& one : times) { // a repetition may have been interrupted
        CHECK(one.ticks > 0);
        CHECK(one.ticks <= 6);
        CHECK(one.ticks % 2 == 0);
    }
    CHECK(probe.best() > 0);
}

TEST_CASE("repetitions on a disturbed machine do not count unless nearly all are disturbed") {
    const std::vector<Repetition> few{
        {1, false, {1, 2, 3}}, {0.9, false, {10}}, {1, true, {20}}, {0.98, false, {4}}};
    const TickTimes undisturbed = summarise_undisturbed(few, 1, 0.97);
    CHECK(undisturbed.ticks == 4);
    CHECK(undisturbed.most == 4);
    CHECK(undisturbed.accepted == 0.5);
    std::vector<Repetition> many(11, Repetition{0.5, false, {10}});
    many.push_back({1, false, {1}});
    const TickTimes all = summarise_undisturbed(many, 1, 0.97);
    CHECK(all.ticks == 12);
    CHECK(all.accepted == Approx(1.0 / 12));
}

TEST_CASE("the arithmetic floor is 1.5 p^2 multiply-adds at the rate of the probe") {
    const double two_vectors = 2;
    const double in_float = arithmetic_floor_us(500, "float", two_vectors);
    CHECK(in_float == Approx(1.5 * 500 * 500 / (2.0 * dfdyn::detail::wide<float>) / 1000));
    CHECK(arithmetic_floor_us(1000, "float", two_vectors) == Approx(4 * in_float));
    CHECK(arithmetic_floor_us(500, "double", two_vectors) ==
          Approx(in_float * dfdyn::detail::wide<float> / dfdyn::detail::wide<double>));
    CHECK(MachineLowerBound{3, 5}.total() == 5);
    CHECK(MachineLowerBound{5, 3}.total() == 5);
}
