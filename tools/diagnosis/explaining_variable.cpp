// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/explaining_variable.hpp"

#include "tools/diagnosis/finding_words.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace dfdyn::tools {

namespace {

constexpr double full_turn = 2 * std::numbers::pi;

/// Where a finding is, and what there is to draw it over.
struct Place {
    const DiagnosisSignals& signals;
    const Finding& finding;
    const Eigen::VectorXd& share;

    Eigen::Index joint() const {
        const std::size_t digits = finding.where.find_first_of("0123456789");
        return digits == std::string::npos ? 0 : std::stol(finding.where.substr(digits)) - 1;
    }
    std::string named(const char* what) const {
        return std::string(what).append(" of joint ").append(std::to_string(joint() + 1));
    }
    double parameter(const char* name) const {
        const auto found = std::ranges::find(finding.parameters, name, &FoundParameter::name);
        return found == finding.parameters.end() ? 0 : found->value;
    }
    ExplainingVariable whole(std::string label, Eigen::VectorXd value) const {
        return {std::move(label), std::move(value), 0, signals.rows(), false};
    }
};

ExplainingVariable over_velocity(const Place& at) {
    return at.whole(at.named("velocity") + " (rad/s)", at.signals.measured.motion.velocity.col(at.joint()));
}

ExplainingVariable over_position(const Place& at) {
    return at.whole(at.named("position") + " (rad)", at.signals.measured.motion.position.col(at.joint()));
}

ExplainingVariable over_acceleration(const Place& at) {
    return at.whole(at.named("acceleration") + " (rad/s²)",
                    at.signals.measured.motion.acceleration.col(at.joint()));
}

ExplainingVariable over_time(const Place& at) {
    ExplainingVariable variable = at.whole("time (s)", at.signals.measured.time_s);
    variable.time = true;
    return variable;
}

ExplainingVariable over_load(const Place& at) {
    return at.whole(at.named("rigid-body torque") + " (N·m)", at.signals.joint_torque.col(at.joint()));
}

/// The load, with the sign of the direction of motion.
ExplainingVariable over_driven_load(const Place& at) {
    const Eigen::ArrayXd velocity = at.signals.measured.motion.velocity.col(at.joint());
    const Eigen::ArrayXd load = at.signals.joint_torque.col(at.joint());
    return at.whole(at.named("|torque| with the sign of the velocity") + " (N·m)",
                    (load.abs() * velocity.sign()).matrix());
}

/// One turn, or what the joint covers of it; for a fine ripple one wave of it, which a turn would show as a
/// blur.
ExplainingVariable over_angle(const Place& at) {
    constexpr double most_waves = 12;
    const double cycles = std::max(1.0, at.parameter("cycles_per_rev"));
    const double period = cycles > most_waves ? full_turn / cycles : full_turn;
    const Eigen::ArrayXd position = at.signals.measured.motion.position.col(at.joint());
    if (position.maxCoeff() - position.minCoeff() < period) {
        return at.whole(at.named("angle") + " (rad)", position.matrix());
    }
    const char* const within = cycles > most_waves ? "angle within one wave" : "angle within one turn";
    return at.whole(at.named(within) + " (rad)", (position - period * (position / period).floor()).matrix());
}

/// How far the joint has travelled since it last reversed, with the sign of the direction.
ExplainingVariable over_travel(const Place& at) {
    const Eigen::VectorXd position = at.signals.measured.motion.position.col(at.joint());
    Eigen::VectorXd travel = Eigen::VectorXd::Zero(position.size());
    for (const Stretch& stretch : at.signals.measured.stretches) {
        double reversal = position[stretch.first];
        for (Eigen::Index row = stretch.first + 1; row < stretch.first + stretch.count; ++row) {
            const double step = position[row] - position[row - 1];
            if (step * (position[row - 1] - reversal) < 0) {
                reversal = position[row - 1];
            }
            travel[row] = position[row] - reversal;
        }
    }
    constexpr double reach = 6; // of the distance over which the friction builds up
    const double distance = at.parameter("break_away") / std::max(1e-9, at.parameter("stiffness"));
    return at.whole(at.named("travel since its last reversal") + " (rad)",
                    travel.cwiseMax(-reach * distance).cwiseMin(reach * distance));
}

/// The stretch of a contact with what is before and after it.
ExplainingVariable around_contact(const Place& at) {
    ExplainingVariable variable = over_time(at);
    const Eigen::VectorXd& time = variable.value;
    const double start = at.parameter("start");
    const double end = at.parameter("end");
    const double margin = std::max(2.0, end - start);
    const double* const first = std::lower_bound(time.data(), time.data() + time.size(), start - margin);
    const double* const last = std::upper_bound(time.data(), time.data() + time.size(), end + margin);
    variable.first = first - time.data();
    variable.count = last - first;
    return variable;
}

ExplainingVariable over_output(const Place& at) {
    return at.whole("simulated output", at.signals.nominal.col(at.finding.output));
}

ExplainingVariable over_share(const Place& at) {
    return at.whole("what the named cause should give", at.share);
}

} // namespace

ExplainingVariable explaining_variable(const DiagnosisSignals& signals, const Finding& finding,
                                       const Eigen::VectorXd& share) {
    using Make = ExplainingVariable (*)(const Place&);
    static const std::map<std::string, Make> known{{"viscous_friction", over_velocity},
                                                   {"coulomb_friction", over_velocity},
                                                   {"stribeck_friction", over_velocity},
                                                   {"load_dependent_friction", over_driven_load},
                                                   {"presliding_hysteresis", over_travel},
                                                   {"torque_offset", over_time},
                                                   {"rotor_inertia", over_acceleration},
                                                   {"joint_spring", over_position},
                                                   {"torque_ripple", over_angle},
                                                   {"encoder_eccentricity", over_angle},
                                                   {"backlash", over_load},
                                                   {"joint_flexibility", over_load},
                                                   {"actuator_gain", over_output},
                                                   {"ft_gain", over_output},
                                                   {"ft_bias", over_time},
                                                   {"ft_drift", over_time},
                                                   {"external_contact", around_contact}};
    const auto make = known.find(finding.effect);
    const Place place{signals, finding, share};
    return make == known.end() ? over_share(place) : make->second(place);
}

} // namespace dfdyn::tools
