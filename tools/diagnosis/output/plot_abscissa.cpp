// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/output/plot_abscissa.hpp"

#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/output/over_time.hpp"
#include "tools/robot/joint_unit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace dfdyn::tools {

Eigen::Index PlottedFinding::joint() const {
    return static_cast<Eigen::Index>(numbered_place(finding.where).value().index);
}

std::string PlottedFinding::named(const char* what, const char* unit) const {
    const bool prismatic = signals.robot.joints[static_cast<std::size_t>(joint())].prismatic;
    return std::string(what)
        .append(" of joint ")
        .append(std::to_string(joint() + 1))
        .append(" (")
        .append(unit_at_joint(unit, prismatic))
        .append(")");
}

double PlottedFinding::parameter(const char* name) const {
    const auto found = std::ranges::find(finding.parameters, name, &FoundParameter::name);
    return found == finding.parameters.end() ? 0 : found->value;
}

PlotAbscissa PlottedFinding::whole(std::string label, Eigen::VectorXd value) const {
    return {std::move(label), std::move(value), 0, signals.rows(), false};
}

PlotAbscissa over_velocity(const PlottedFinding& at) {
    return at.whole(at.named("velocity", "rad/s"), at.signals.measured.motion.velocity.col(at.joint()));
}

PlotAbscissa over_position(const PlottedFinding& at) {
    return at.whole(at.named("position", "rad"), at.signals.measured.motion.position.col(at.joint()));
}

PlotAbscissa over_time(const PlottedFinding& at) {
    const TimeAxis axis = time_axis(at.signals.measured);
    PlotAbscissa variable = at.whole(axis.label, at.signals.measured.time_s.array() - axis.origin_s);
    variable.time = true;
    return variable;
}

PlotAbscissa over_load(const PlottedFinding& at) {
    return at.whole(at.named("rigid-body torque", "N·m"), at.signals.joint_torque.col(at.joint()));
}

PlotAbscissa over_angle(const PlottedFinding& at) {
    constexpr double full_turn = 2 * std::numbers::pi;
    constexpr double most_waves = 12;
    const double cycles = std::max(1.0, at.parameter(cycles_per_turn));
    const double period = cycles > most_waves ? full_turn / cycles : full_turn;
    const Eigen::ArrayXd position = at.signals.measured.motion.position.col(at.joint());
    if (position.maxCoeff() - position.minCoeff() < period) {
        return at.whole(at.named("angle", "rad"), position.matrix());
    }
    const char* const within = cycles > most_waves ? "angle within one wave" : "angle within one turn";
    return at.whole(at.named(within, "rad"), (position - period * (position / period).floor()).matrix());
}

PlotAbscissa over_output(const PlottedFinding& at) {
    return at.whole("simulated output", at.signals.nominal.col(at.finding.output));
}

PlotAbscissa plot_abscissa(const DiagnosisSignals& signals, const Finding& finding,
                           const Eigen::VectorXd& share) {
    const PlottedFinding plotted{signals, finding, share};
    const Effect& effect = effect_named(finding.effect);
    return effect.plotted_over != nullptr ? effect.plotted_over(plotted)
                                          : plotted.whole("contribution predicted by the named cause", share);
}

} // namespace dfdyn::tools
