// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dfdyn/dfdyn.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace dfdyn::tests {

/// State of a two-joint arm at a time, and the corresponding torque.
struct ArmState {
    std::array<double, 2> position, velocity, acceleration;

    [[nodiscard]] double torque(std::size_t joint) const {
        return 2 * std::sin(position[joint]) + 0.3 * std::cos(position[0] + position[1]) +
               0.2 * velocity[joint] + 0.05 * acceleration[joint];
    }
};

inline constexpr double first_link_length = 0.4;

/// A planar arm in the vertical plane: both axes along z, gravity along -y.
template <class Constants>
constexpr void set_two_links(Constants& chain) {
    for (int i = 0; i < 2; ++i) {
        auto& joint = chain.joint[i];
        joint = {};
        joint.placement.rotation[0] = joint.placement.rotation[4] = joint.placement.rotation[8] = 1;
        joint.axis[2] = 1;
    }
    using Scalar = std::remove_cvref_t<decltype(chain.gravity[0])>;
    chain.joint[1].placement.translation[0] = static_cast<Scalar>(first_link_length);
    chain.gravity[1] = Scalar(-9.81);
}

/// The columns that the torques depend on, all linearly independent: first moments and inertia of both
/// bodies, then viscous friction and offset of both joints.
inline constexpr int two_link_column_count = 10;
inline constexpr std::array<std::int32_t, two_link_column_count> two_link_columns{1,  2,  9,  11, 12,
                                                                                  19, 20, 21, 22, 23};
inline constexpr std::array<double, two_link_column_count> two_link_parameters{0.4,  0.05, 0.2, 0.15, -0.02,
                                                                               0.06, 0.3,  0.2, 0.5,  -0.3};

/// Returns the torques of that arm, optionally plus a term outside its physics.
inline std::array<double, 2> two_link_torques(const ArmState& arm, bool with_unknown) {
    using Plant = Physics<StandardMeasured, two_link_column_count, ViscousFriction<2>, OutputOffset<2>>;
    Plant::Constants<double, Chain<2>> constants{};
    set_two_links(constants.chain);
    constants.effects = {{{{0, 1}}}, {{{0, 1}}}};
    std::ranges::copy(two_link_columns, constants.selected.begin());
    std::ranges::fill(constants.column_scale, 1);
    constants.output_gain = {{1, 1}};
    const double xi[] = {arm.position[0], arm.velocity[0], arm.acceleration[0],
                         arm.position[1], arm.velocity[1], arm.acceleration[1]};
    double psi[2 * two_link_column_count];
    Plant::evaluate_rows<Chain<2>>(constants, {}, xi, psi);
    std::array<double, 2> torques{};
    for (std::size_t k = 0; k < 2; ++k) {
        torques[k] = with_unknown ? 0.3 * std::sin(3 * arm.position[k]) : 0;
        for (std::size_t c = 0; c < two_link_parameters.size(); ++c) {
            torques[k] += psi[k * two_link_parameters.size() + c] * two_link_parameters[c];
        }
    }
    return torques;
}

} // namespace dfdyn::tests
