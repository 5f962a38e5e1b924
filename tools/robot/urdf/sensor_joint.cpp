// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/error.hpp"
#include "tools/base/text/text.hpp"
#include "tools/robot/urdf/urdf_chain.hpp"

#include <algorithm>
#include <cctype>

namespace dfdyn::tools {

namespace {

using Joints = std::vector<urdf::JointConstSharedPtr>;

std::vector<std::string> names_of(const Joints& joints) {
    std::vector<std::string> names;
    for (const auto& joint : joints) {
        names.push_back(joint->name);
    }
    return names;
}

/// Returns whether `name` contains `ft` between characters that are not letters.
bool has_word_ft(const std::string& name) {
    const auto letter = [&name](std::size_t at) {
        return at < name.size() && std::isalpha(static_cast<unsigned char>(name[at])) != 0;
    };
    for (std::size_t at = name.find("ft"); at != std::string::npos; at = name.find("ft", at + 1)) {
        if ((at == 0 || !letter(at - 1)) && !letter(at + 2)) {
            return true;
        }
    }
    return false;
}

bool sounds_like_sensor(const std::string& name) {
    return name.find("force_torque") != std::string::npos || name.find("ft_sensor") != std::string::npos ||
           has_word_ft(name);
}

urdf::JointConstSharedPtr the_wanted(const Joints& fixed, const std::string& wanted,
                                     const std::string& file) {
    const auto found = std::ranges::find(fixed, wanted, &urdf::Joint::name);
    if (found == fixed.end()) {
        throw InputError(file + ": expected F/T joint " + in_quotes(wanted) +
                         " to be a fixed joint between base and tip, found there: " +
                         (fixed.empty() ? "none" : listed(names_of(fixed))));
    }
    return *found;
}

} // namespace

urdf::JointConstSharedPtr find_sensor_joint(const Joints& chain, const std::vector<DeclaredSensor>& declared,
                                            const std::string& wanted, const std::string& file,
                                            std::vector<std::string>& notes) {
    Joints fixed;
    std::ranges::copy_if(chain, std::back_inserter(fixed),
                         [](const auto& joint) { return joint->type == urdf::Joint::FIXED; });
    if (!wanted.empty()) {
        return the_wanted(fixed, wanted, file);
    }
    Joints candidates;
    std::ranges::copy_if(fixed, std::back_inserter(candidates), [&declared](const auto& joint) {
        return std::ranges::find(declared, joint->name, &DeclaredSensor::joint) != declared.end();
    });
    if (candidates.empty()) {
        std::ranges::copy_if(fixed, std::back_inserter(candidates),
                             [](const auto& joint) { return sounds_like_sensor(joint->name); });
    }
    if (candidates.size() > 1) {
        notes.push_back("several fixed joints may carry the F/T sensor, none is used: " +
                        listed(names_of(candidates)));
    }
    return candidates.size() == 1 ? candidates.front() : nullptr;
}

} // namespace dfdyn::tools
