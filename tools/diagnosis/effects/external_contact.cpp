// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/candidates/contact_pulse.hpp"
#include "tools/diagnosis/candidates/event_products.hpp"
#include "tools/diagnosis/candidates/weighted_residual.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/effects/effect_internals.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"
#include "tools/robot/firmware_chain.hpp"

#include <algorithm>

namespace dfdyn::tools {

namespace {

/// Outputs (T x m) for a force of 1 N along `axis` at the tip: those of an arm at rest that consists of 1 kg
/// at its tip only, with gravity of 1 m/s² along `axis`.
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
    result.where = site.where;
    result.detail = std::move(detail);
    result.event = true;
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
    result.relinearized_at = [&signals, &site, pulses, reach,
                              detail = result.detail](const EffectShape& shape, const Eigen::VectorXd&) {
        const double nearer = std::max(0.02, reach / 2);
        return contact_with_shapes(signals, site, detail, nearer,
                                   pulses_about(pulses[static_cast<std::size_t>(shape.value)], nearer));
    };
    return result;
}

/// Appends the candidate windows of one length to `found`.
void scan_windows(const DiagnosisSignals& signals, const EffectRegression& regression,
                  const Eigen::MatrixXd& weighted, const ContactSite& site, double length_s,
                  std::vector<EventWindow>& found) {
    const Eigen::VectorXd& time = signals.measured.time_s;
    const auto length = static_cast<Eigen::Index>(length_s * signals.measured.rate_hz);
    const Eigen::Index middle = time.size() / 2;
    if (middle + length >= time.size()) {
        return;
    }
    const Eigen::VectorXd series =
        pulse_series(signals, {time[middle], time[middle + length], push_flanks * length_s});
    const EventProducts products(site.components, weighted, weighted_share(regression, series));
    const Eigen::VectorXd shape = series.segment(middle, length);
    const Eigen::VectorXd shape_square = shape.cwiseAbs2();
    for (Eigen::Index first = 0; first + length < time.size();
         first += std::max<Eigen::Index>(1, length / 8)) {
        const double explained =
            products.explained(products.moment.middleRows(first, length).transpose() * shape,
                               products.square.middleRows(first, length).transpose() * shape_square);
        found.push_back({explained, time[first], time[first + length]});
    }
}

class ContactScan : public EffectScan {
  public:
    explicit ContactScan(const DiagnosisSignals& signals) : sites_(contact_sites(signals)) {}

    std::vector<Candidate> candidates(const FittedResidual& residual) const override {
        return scan_contacts(residual.signals, residual.regression,
                             weighted_residual_away_from_reversals(residual.signals, residual.regression,
                                                                   residual.coefficients),
                             sites_);
    }
    /// Gives all contacts at a site the same evidence offset. After the largest ones are chosen, the
    /// remaining ones differ less from each other.
    void set_evidence_offsets(const std::vector<Candidate*>& own,
                              const FittedResidual& /*residual*/) const override {
        for (const Candidate* const one : own) {
            for (Candidate* const other : own) {
                if (one->where == other->where) {
                    other->evidence_offset = std::max(other->evidence_offset, one->evidence_offset);
                }
            }
        }
    }

  private:
    std::vector<ContactSite> sites_;
};

/// Time, limited to the contact and the time before and after it.
PlotAbscissa around_contact(const PlottedFinding& at) {
    PlotAbscissa variable = over_time(at);
    const Eigen::VectorXd& time = at.signals.measured.time_s; // as the parameters, also for times since 1970
    const double start = at.parameter(contact_start.name);
    const double end = at.parameter(contact_end.name);
    const double margin = std::max(2.0, end - start);
    const double* const first = std::lower_bound(time.data(), time.data() + time.size(), start - margin);
    const double* const last = std::upper_bound(time.data(), time.data() + time.size(), end + margin);
    variable.first = first - time.data();
    variable.count = last - first;
    return variable;
}

} // namespace

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
        // negative: a torque that the environment exerts reduces the actuator's torque
        sites.push_back({place_text(PlaceKind::joint, static_cast<std::size_t>(joint)),
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

std::vector<Candidate> scan_contacts(const DiagnosisSignals& signals, const EffectRegression& regression,
                                     const Eigen::MatrixXd& weighted, const std::vector<ContactSite>& sites) {
    std::vector<Candidate> result;
    for (const ContactSite& site : sites) {
        std::vector<EventWindow> windows;
        for (const double length_s : push_lengths_s) {
            scan_windows(signals, regression, weighted, site, length_s, windows);
        }
        const std::vector<EventWindow> events = events_of(windows, events_apart_s);
        if (const std::optional<double> demanded = noise_event_threshold(events)) {
            const EventWindow& best = events.front();
            const ContactPulse pulse{best.start_s, best.end_s, push_flanks * (best.end_s - best.start_s)};
            result.push_back(contact_candidate(signals, site, pulse, pulses_about(pulse, 0.15)));
            result.back().prior_trials = static_cast<double>(windows.size());
            result.back().evidence_offset = *demanded;
        }
    }
    return result;
}

Effect effects::external_contact() {
    return {.name = "external_contact",
            .where = "jointK, ft_sensor",
            .parameters = {contact_start, contact_end, contact_peak, contact_direction[0],
                           contact_direction[1], contact_direction[2]},
            .remark = ": the direction of a force at the tip",
            .evidence = "is there for a stretch of time only",
            .experiment = "repeat the motion with nothing within reach of the arm",
            .in_extended_model = "left out: an event, not a property of the arm",
            .beyond_arm = true,
            .interval = true,
            .burst_evidence = 3,
            .scan = [](const DiagnosisSignals& signals, const SpectralRows&) -> std::unique_ptr<EffectScan> {
                return std::make_unique<ContactScan>(signals);
            },
            .plotted_over = around_contact};
}

} // namespace dfdyn::tools
