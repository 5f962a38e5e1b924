// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/model/model.hpp"

#include <span>
#include <string>
#include <vector>

namespace dfdyn::tools {

/// How the physics' parameters are determined.
enum class PhysicsRole {
    none,          ///< the model has no physics
    fixed_first,   ///< least squares of the physics alone; the features learn its residual
    fixed_jointly, ///< the same, with generalised least squares and the kernel of the features
    learned,       ///< learned online
};

/// A structure of the paper's models (Section III): its name and its parts. To add one: a constant in this
/// file, a line in structure.cpp, and its types in the firmware and in run_time.
struct Structure {
    const char* name; ///< on the command line and in model.json
    const char*
        firmware_type; ///< of the structure, a template over the physics; null: the firmware's default
    bool features;     ///< random features
    PhysicsRole physics;

    constexpr bool has_physics() const { return physics != PhysicsRole::none; }
    constexpr bool learns_parameters() const { return physics == PhysicsRole::learned; }
    /// The features' weights and the physics' parameters are learned together.
    constexpr bool coupled() const { return features && learns_parameters(); }
    /// The likelihood has the kernel of the features and the physics' columns at once.
    constexpr bool fits_jointly() const {
        return features && (learns_parameters() || physics == PhysicsRole::fixed_jointly);
    }
};

namespace structures {

inline constexpr Structure NP{"NP", nullptr, true, PhysicsRole::none};
inline constexpr Structure P{"P", "Parametric", false, PhysicsRole::learned};
inline constexpr Structure SP{"SP", "SemiparametricMean", true, PhysicsRole::fixed_jointly};
inline constexpr Structure SP2{"SP2", "SemiparametricMean", true, PhysicsRole::fixed_first};
inline constexpr Structure SPK{"SPK", "SemiparametricKernel", true, PhysicsRole::learned};

} // namespace structures

/// Returns all structures, in the order of messages.
std::span<const Structure* const> all_structures();

/// Returns the structure with this name, or null for an unknown name.
const Structure* find_structure(const std::string& name);

/// Returns the structure with this name. Throws InputError with a list of the names for any other.
const Structure& structure(const std::string& name);

/// Returns the structure of a valid model.
const Structure& structure_of(const TrainedModel& model);

/// Returns the names, in the order of all_structures().
std::vector<std::string> structure_names();

} // namespace dfdyn::tools
