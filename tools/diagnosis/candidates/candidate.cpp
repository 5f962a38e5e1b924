// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate.hpp"

#include <algorithm>
#include <array>

namespace dfdyn::tools {

namespace {

struct PlaceName {
    PlaceKind kind;
    const char* name;
};
constexpr std::array place_names{PlaceName{PlaceKind::joint, "joint"},
                                 PlaceName{PlaceKind::actuator, "actuator"},
                                 PlaceName{PlaceKind::encoder, "encoder"}, PlaceName{PlaceKind::link, "link"},
                                 PlaceName{PlaceKind::output, "output"}};

} // namespace

std::string place_text(PlaceKind kind, std::size_t index) {
    std::string result(std::ranges::find(place_names, kind, &PlaceName::kind)->name);
    return result += std::to_string(index + 1);
}

std::optional<Place> numbered_place(const std::string& text) {
    const std::size_t digits = text.find_first_of("0123456789");
    const std::string name = text.substr(0, digits);
    const auto* const found =
        std::ranges::find_if(place_names, [&](const PlaceName& one) { return name == one.name; });
    if (digits == std::string::npos || found == place_names.end()) {
        return std::nullopt;
    }
    return Place{found->kind, std::stoul(text.substr(digits)) - 1};
}

} // namespace dfdyn::tools
