// SPDX-License-Identifier: Apache-2.0
#include "tools/robot/joint_unit.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace dfdyn::tools {

std::string unit_at_joint(const std::string& unit, bool prismatic) {
    static constexpr std::array<std::pair<const char*, const char*>, 10> units{{{"N·m·s/rad", "N·s/m"},
                                                                                {"A·s/rad", "A·s/m"},
                                                                                {"N·m/rad", "N/m"},
                                                                                {"N·m/A", "N/A"},
                                                                                {"N·m/s", "N/s"},
                                                                                {"N·m", "N"},
                                                                                {"rad/s²", "m/s²"},
                                                                                {"rad/s", "m/s"},
                                                                                {"rad", "m"},
                                                                                {"kg·m²", "kg"}}};
    const auto* const found =
        std::ranges::find_if(units, [&](const auto& entry) { return unit == entry.first; });
    return prismatic && found != units.end() ? found->second : unit;
}

} // namespace dfdyn::tools
