// SPDX-License-Identifier: Apache-2.0
#include "tools/base/text/number.hpp"
#include "tools/simulation/scenario/scenario_reader.hpp"

#include <string>

namespace dfdyn::tools {

namespace {

LuGreParameters one_friction(const std::vector<JointVector>& values, Eigen::Index joint) {
    LuGreParameters result;
    result.stiffness = values[0][joint];
    result.damping = values[1][joint];
    result.viscous = values[2][joint];
    result.coulomb = values[3][joint];
    result.breakaway = values[4][joint];
    result.stribeck_velocity = values[5][joint];
    result.negative_excess = values[6][joint] - values[3][joint];
    result.load_coefficient = values[7][joint];
    result.drift_per_s = values[8][joint];
    return result;
}

/// Refuses friction of a joint that the model cannot represent, and friction that would have no effect.
void check_friction(const JsonReader& reader, const LuGreParameters& one) {
    const bool slips = one.coulomb > 0 || one.load_coefficient > 0;
    if (one.stiffness > 0 && !(slips && one.stribeck_velocity > 0)) {
        throw reader.error("coulomb_nm",
                           "bristles to have a positive coulomb_nm and "
                           "stribeck_velocity_rad_per_s at every joint",
                           "0 or less");
    }
    if (one.load_coefficient > 0 && one.damping != 0) {
        throw reader.error("damping_nms_per_rad", "no damping where there is a load_coefficient",
                           number_text(one.damping));
    }
    if (one.breakaway < one.coulomb) {
        throw reader.error("static_nm", "at least coulomb_nm at every joint", "less");
    }
    const double backwards = one.coulomb + one.negative_excess;
    const bool of_bristles = slips || one.breakaway > 0 || backwards > 0 || one.damping > 0;
    if (one.stiffness == 0 && of_bristles) { // without bristles they would have no effect
        throw reader.error("stiffness_nm_per_rad",
                           "a positive number at every joint with other than viscous friction", "0");
    }
}

std::vector<LuGreParameters> read_friction(const ScenarioReader& reader) {
    static constexpr const char* names[] = {
        "stiffness_nm_per_rad", "damping_nms_per_rad", "viscous_nms_per_rad",
        "coulomb_nm",           "static_nm",           "stribeck_velocity_rad_per_s",
        "coulomb_negative_nm",  "load_coefficient"};
    static constexpr const char* drift = "drift_per_s"; // of either sign
    reader.allow_only(
        {names[0], names[1], names[2], names[3], names[4], names[5], names[6], names[7], drift});
    std::vector<JointVector> values;
    for (const char* name : names) {
        values.push_back(reader.not_negative_per_joint(name));
    }
    values.push_back(reader.per_joint(drift, 0));
    if (!reader.json().has(names[6])) {
        values[6] = values[3];
    }
    std::vector<LuGreParameters> friction;
    for (Eigen::Index joint = 0; joint < values[0].size(); ++joint) {
        friction.push_back(one_friction(values, joint));
        check_friction(reader.json(), friction.back());
    }
    return friction;
}

/// `rotor_inertia`: kg·m² of each joint.
GearModel read_gear(const ScenarioReader& reader, const JointVector& rotor_inertia) {
    reader.allow_only({"stiffness_nm_per_rad", "damping_nms_per_rad", "gap_rad"});
    GearModel gear;
    gear.stiffness = reader.not_negative_per_joint("stiffness_nm_per_rad");
    gear.damping = reader.not_negative_per_joint("damping_nms_per_rad");
    gear.gap = reader.not_negative_per_joint("gap_rad");
    if (const Eigen::Index found = gear.coordinate_count(gear.stiffness.size());
        found > largest_simulated_chain) {
        throw reader.json().error("stiffness_nm_per_rad",
                                  "at most " + std::to_string(largest_simulated_chain) +
                                      " joints, each soft one counted twice",
                                  std::to_string(found));
    }
    for (Eigen::Index joint = 0; joint < gear.gap.size(); ++joint) {
        if (gear.soft(joint) && !(rotor_inertia[joint] > 0)) {
            throw reader.json().error("stiffness_nm_per_rad", "a rotor_inertia_kgm2 at every soft joint",
                                      "none");
        }
        if (gear.gap[joint] > 0 && !gear.soft(joint)) {
            throw reader.json().error("gap_rad", "gaps at joints with a stiffness_nm_per_rad only",
                                      number_text(gear.gap[joint]));
        }
    }
    return gear;
}

} // namespace

ActuatorModel read_actuators(const ScenarioReader& reader) {
    reader.allow_only({"rotor_inertia_kgm2", "torque_limit_nm", "torque_constant_nm_per_a", "torque_noise_nm",
                       "torque_gain", "torque_offset_nm", "torque_delay_s", "bandwidth_hz", "friction",
                       "gear", "ripple"});
    ActuatorModel model;
    model.rotor_inertia = reader.not_negative_per_joint("rotor_inertia_kgm2");
    if (reader.json().has("torque_limit_nm")) {
        model.torque_limit = reader.positive_per_joint("torque_limit_nm");
    }
    model.bandwidth_hz = reader.within("bandwidth_hz", 0, 1e5, 0);
    if (reader.json().has("gear")) {
        model.gear = read_gear(reader.object("gear"), model.rotor_inertia);
    }
    model.friction = reader.json().has("friction")
                         ? read_friction(reader.object("friction"))
                         : std::vector<LuGreParameters>(static_cast<std::size_t>(reader.joint_count()));
    return model;
}

TorqueSensorModel read_torque_sensor(const ScenarioReader& reader) {
    TorqueSensorModel model;
    model.noise = reader.per_joint("torque_noise_nm", 0);
    if (reader.json().has("torque_constant_nm_per_a")) {
        model.torque_constant = reader.positive_per_joint("torque_constant_nm_per_a");
    }
    if (reader.json().has("torque_gain")) {
        model.gain = reader.positive_per_joint("torque_gain");
    }
    model.offset = reader.optional_per_joint("torque_offset_nm");
    model.delay_s = reader.optional_per_joint("torque_delay_s");
    if (model.delay_s) {
        const double least = model.delay_s->minCoeff();
        const double most = model.delay_s->maxCoeff();
        if (!(least >= 0 && most <= 10)) {
            throw reader.json().error("torque_delay_s", "numbers from 0 to 10",
                                      number_text(least < 0 ? least : most));
        }
    }
    return model;
}

} // namespace dfdyn::tools
