// SPDX-License-Identifier: Apache-2.0
#include "dfdyn/core/status.hpp"

#include "tests/support/catch.hpp"

#include <set>
#include <string>
#include <utility>

namespace status_test {

using dfdyn::Reason;
using dfdyn::Status;

/// The numbers and names in recordings and logs, which never change.
constexpr std::pair<int, const char*> published[] = {
    {0, "ok"},
    {1, "window_filling"},
    {2, "gap"},
    {3, "clock_restarted"},
    {4, "output_missing"},
    {5, "learning_in_progress"},
    {6, "learner_busy"},
    {7, "no_budget"},
    {8, "learning_held"},
    {9, "prediction_bounded"},
    {32, "position_not_finite"},
    {33, "position_out_of_range"},
    {34, "time_not_increasing"},
    {35, "input_out_of_range"},
    {36, "output_not_finite"},
    {37, "output_out_of_range"},
    {38, "innovation_too_large"},
    {39, "state_not_finite"},
};

TEST_CASE("reasons keep their numbers and names") {
    std::set<int> known;
    for (const auto& [number, text] : published) {
        CHECK(dfdyn::name(static_cast<Reason>(number)) == std::string(text));
        known.insert(number);
    }
    for (int number = 0; number < 256; ++number) {
        if (!known.contains(number)) {
            CHECK(dfdyn::name(static_cast<Reason>(number)) == std::string("unknown"));
        }
    }
    CHECK(dfdyn::reason_count == *known.rbegin() + 1);
}

TEST_CASE("faults begin at 32") {
    for (const auto& [number, text] : published) {
        CHECK(dfdyn::is_fault(static_cast<Reason>(number)) == (number >= 32));
    }
}

TEST_CASE("a status reports the prediction's reason before learning's") {
    CHECK(Status{}.learned());
    CHECK(Status{}.reason() == Reason::ok);
    const Status blind{Reason::ok, Reason::output_missing};
    CHECK(blind.predicted());
    CHECK_FALSE(blind.learned());
    CHECK(blind.reason() == Reason::output_missing);
    const Status refused{Reason::gap, Reason::ok};
    CHECK_FALSE(refused.predicted());
    CHECK_FALSE(refused.learned());
    CHECK(refused.reason() == Reason::gap);
}

} // namespace status_test
