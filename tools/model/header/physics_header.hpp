// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/header/header_text.hpp"
#include "tools/model/run_time/host_model.hpp"

#include <string>
#include <type_traits>
#include <variant>

namespace dfdyn::tools {

// The C++ types of a model's parts, and their constants as C++ initializers.

std::string input_type(const InputModel& input);
std::string arm_type(const ChainModel& chain);
std::string physics_type(const PhysicsModel& physics);

/// `Input`: a constants object of AnyInput, or of NoInput.
template <class Input>
std::string input_constants(const Input& input) {
    if constexpr (std::is_empty_v<Input>) {
        return "{}";
    } else {
        return std::visit(
            [](const auto& own) {
                std::string fields;
                if constexpr (requires { own.position_noise_bound; }) {
                    fields += ".position_noise_bound = " + literal(own.position_noise_bound) + ",\n        ";
                }
                if constexpr (requires { own.rows; }) {
                    fields += ".rows = " + literal(own.rows) + ",\n        ";
                }
                return "{" + fields + ".scale = " + literal(own.scale) + "}";
            },
            input);
    }
}

/// `Arm`: TorqueArm or WrenchArm.
template <class Arm>
std::string chain_constants(const typename Arm::template Constants<float>& chain);
template <class Arm>
std::string physics_constants(const typename HostPhysics::template Constants<float, Arm>& physics);

} // namespace dfdyn::tools
