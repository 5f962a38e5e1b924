// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate.hpp"

#include "tests/support/catch.hpp"

namespace place_test {

using namespace dfdyn::tools;

TEST_CASE("the name of a numbered place is read as its kind and its index") {
    for (const PlaceKind kind :
         {PlaceKind::joint, PlaceKind::actuator, PlaceKind::encoder, PlaceKind::link, PlaceKind::output}) {
        for (const std::size_t index : {0U, 1U, 11U}) {
            const std::string text = place_text(kind, index);
            CAPTURE(text);
            const std::optional<Place> place = numbered_place(text);
            REQUIRE(place.has_value());
            CHECK(place->kind == kind);
            CHECK(place->index == index);
        }
    }
    CHECK(place_text(PlaceKind::joint, 2) == "joint3");
}

TEST_CASE("a place without a number has no index") {
    for (const char* const text : {"", "base", "tool", "ft_sensor", "joint", "arm2"}) {
        CAPTURE(text);
        CHECK_FALSE(numbered_place(text).has_value());
    }
}

} // namespace place_test
