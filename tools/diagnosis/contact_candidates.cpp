// SPDX-License-Identifier: Apache-2.0
#include "tools/common/number.hpp"
#include "tools/diagnosis/candidate_parts.hpp"
#include "tools/diagnosis/candidates.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace dfdyn::tools {

namespace {

/// The outputs of an arm of nothing but 1 kg at its tip, at rest, while gravity is 1 m/s² along `axis`: of 1
/// N along it. T x m.
Eigen::MatrixXd of_force_at_tip(const DiagnosisSignals& signals, const Eigen::Vector3d& axis) {
    const InertialParameters mass = moved(
        body_parameters(1, Eigen::Vector3d::Zero(), Eigen::Matrix3d::Zero()), signals.robot.tip_placement);
    Robot robot = signals.robot;
    robot.gravity = axis;
    for (RobotJoint& joint : robot.joints) {
        joint.inertia.setZero();
    }
    robot.joints.back().inertia = mass;
    if (robot.sensor) {
        robot.sensor->inertia_beyond.setZero();
        if (robot.sensor->link == robot.joints.size()) {
            robot.sensor->inertia_beyond = mass;
        }
    }
    RobotMotion rest = signals.measured.motion;
    rest.velocity.setZero();
    rest.acceleration.setZero();
    return rigid_outputs(robot, signals.kind, rest);
}

EffectColumn during(const EffectColumn& column, const Eigen::VectorXd& pulse) {
    EffectColumn result = column;
    for (EffectColumn::Part& part : result.parts) {
        part.series = part.series.cwiseProduct(pulse);
    }
    return result;
}

Candidate contact_with_shapes(const DiagnosisSignals& signals, const ContactSite& site, std::string detail,
                              double reach, const std::vector<ContactPulse>& pulses) {
    Candidate result;
    result.effect = "external_contact";
    result.where = site.where;
    result.detail = std::move(detail);
    for (const ContactPulse& pulse : pulses) {
        const Eigen::VectorXd series = pulse_series(signals, pulse);
        EffectShape shape{{}, is_anything, static_cast<double>(result.shapes.size())};
        for (const EffectColumn& component : site.components) {
            shape.columns.push_back(result.columns.size());
            result.columns.push_back(during(component, series));
        }
        result.shapes.push_back(std::move(shape));
    }
    result.parameters = [pulses, unit = site.unit](const Eigen::VectorXd& coefficients,
                                                   const EffectShape& shape) {
        return contact_parameters(pulses[static_cast<std::size_t>(shape.value)], unit, coefficients);
    };
    result.about = [&signals, &site, pulses, reach, detail = result.detail](const EffectShape& shape,
                                                                            const Eigen::VectorXd&) {
        const double nearer = std::max(0.02, reach / 2);
        return contact_with_shapes(signals, site, detail, nearer,
                                   pulses_about(pulses[static_cast<std::size_t>(shape.value)], nearer));
    };
    return result;
}

} // namespace

std::vector<EffectParameter> contact_parameters(const ContactPulse& pulse, const std::string& unit,
                                                const Eigen::VectorXd& components) {
    std::vector<EffectParameter> values{
        {"start", "s", pulse.start_s, pulse.start_s}, // no time means nothing
        {"end", "s", pulse.end_s, pulse.end_s},
        {"peak", unit, components.size() == 1 ? components[0] : components.norm()}};
    constexpr std::array names{"base_x", "base_y", "base_z"};
    for (std::size_t axis = 0; components.size() > 1 && axis < names.size(); ++axis) {
        values.push_back({names[axis], "1", components[static_cast<Eigen::Index>(axis)] / components.norm()});
    }
    return values;
}

std::string start_words(const ContactPulse& pulse) { return formatted("%.2f s", pulse.start_s); }

double pulse_at(const ContactPulse& pulse, double time_s) {
    const double inside = std::min(time_s - pulse.start_s, pulse.end_s - time_s);
    return (1 - std::cos(std::numbers::pi * std::clamp(inside / pulse.rise_s, 0.0, 1.0))) / 2;
}

Eigen::VectorXd pulse_series(const DiagnosisSignals& signals, const ContactPulse& pulse) {
    return signals.measured.time_s.unaryExpr([&](double time_s) { return pulse_at(pulse, time_s); });
}

std::vector<ContactPulse> pulses_about(const ContactPulse& pulse, double reach) {
    const double length = pulse.end_s - pulse.start_s;
    std::vector<ContactPulse> pulses;
    for (const double steeper : {0.0, -1.0, 1.0}) {
        const double rise = std::clamp(pulse.rise_s / length + steeper * reach, 0.05, 0.5);
        for (const double early : {0.0, -reach, reach}) {
            for (const double late : {0.0, -reach, reach}) {
                const double start = pulse.start_s + early * length;
                const double end = pulse.end_s + late * length;
                pulses.push_back({start, end, rise * (end - start)});
            }
        }
    }
    return pulses;
}

std::vector<ContactSite> contact_sites(const DiagnosisSignals& signals) {
    std::vector<ContactSite> sites;
    if (signals.wrench()) {
        ContactSite tip{"ft_sensor", "N", {}};
        for (int axis = 0; axis < 3; ++axis) {
            tip.components.push_back(on_outputs(of_force_at_tip(signals, Eigen::Vector3d::Unit(axis))));
        }
        return {std::move(tip)};
    }
    for (Eigen::Index joint = 0; joint < signals.outputs(); ++joint) {
        // what the surroundings exert, the actuators need not
        sites.push_back({numbered("joint", static_cast<std::size_t>(joint)),
                         "N·m",
                         {on_output(joint, -Eigen::VectorXd::Ones(signals.rows()))}});
    }
    return sites;
}

Candidate contact_candidate(const DiagnosisSignals& signals, const ContactSite& site,
                            const ContactPulse& first, const std::vector<ContactPulse>& pulses) {
    constexpr double reach = 0.15;
    return contact_with_shapes(signals, site, start_words(first), reach, pulses);
}

} // namespace dfdyn::tools
