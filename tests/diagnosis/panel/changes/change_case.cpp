// SPDX-License-Identifier: Apache-2.0
#include "tests/diagnosis/panel/changes/change_case.hpp"

#include "tests/diagnosis/panel/recording/panel_random.hpp"
#include "tests/tools/support/append_row.hpp"
#include "tools/base/text/number.hpp"
#include "tools/model/structure.hpp"
#include "tools/replay/contradiction.hpp"
#include "tools/simulation/simulation.hpp"
#include "tools/training/model_training.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace dfdyn::tests {

using namespace tools;

namespace {

constexpr double change_rate_hz = 100;
constexpr double change_integration_rate_hz = 2000;
/// The learner and the monitor's noise estimate have converged by then.
constexpr double earliest_s = 60;
constexpr double trained_s = 25;

/// Properties of an arm that its URDF does not contain, and the sizes of its changes.
struct ChangeArm {
    std::string name;
    double rotor_inertia, coulomb, stiffness; ///< of the first joint, kg·m², N·m and N·m/rad
    std::vector<double> joint_share;          ///< of each joint, relative to the first
    double torque_noise;                      ///< N·m, of the first joint
    double payload_from, payload_to;          ///< kg
    double push_from, push_to;                ///< N
};

const ChangeArm& change_arm(const std::string& name) {
    static const ChangeArm ur5{"ur5_torque", 1, 8, 20000, {1, 1, 1, 0.25, 0.25, 0.25}, 0.4, 0.5, 3, 30, 100};
    static const ChangeArm icub{"icub_wrench", 0.03, 0.8, 600, {1, 1, 0.6, 0.6}, 0.02, 0.1, 0.5, 4, 15};
    static const ChangeArm three{"three_joint_torque", 0.2, 2.5, 5000, {1, 1, 0.5}, 0.1, 0.3, 1.5, 10, 40};
    return name == ur5.name ? ur5 : name == icub.name ? icub : three;
}

JointVector shares(const ChangeArm& arm) {
    return Eigen::Map<const JointVector>(arm.joint_share.data(),
                                         static_cast<Eigen::Index>(arm.joint_share.size()));
}

LuGreParameters friction(const ChangeArm& arm, double share) {
    LuGreParameters one;
    one.stiffness = arm.stiffness * share;
    one.damping = 0.003 * one.stiffness;
    one.viscous = arm.coulomb * share;
    one.coulomb = arm.coulomb * share;
    one.breakaway = 1.35 * one.coulomb;
    one.stribeck_velocity = 0.06;
    return one;
}

Scenario change_scenario(const PanelRobot& kind, const Robot& robot, double duration_s, Draw& draw) {
    const ChangeArm& arm = change_arm(kind.name);
    const JointVector share = shares(arm);
    Scenario scenario;
    scenario.seed = draw.seed();
    scenario.integration_rate_hz = change_integration_rate_hz;
    scenario.recording.rate_hz = change_rate_hz;
    scenario.recording.samples = static_cast<std::size_t>(duration_s * change_rate_hz);
    scenario.task = random_task(kind, robot, duration_s, draw);
    scenario.controller.rate_hz = 500;
    scenario.controller.position_gain = JointVector::Constant(share.size(), 400);
    scenario.controller.velocity_gain = JointVector::Constant(share.size(), 40);
    scenario.controller.mass_error = 0.1;
    scenario.actuators.rotor_inertia = arm.rotor_inertia * share;
    for (const double one : share) {
        scenario.actuators.friction.push_back(friction(arm, one));
    }
    scenario.torque_sensor.noise = arm.torque_noise * share * draw.uniform(0.5, 1.5);
    scenario.encoders.eccentricity = scenario.encoders.eccentricity_phase = JointVector::Zero(share.size());
    scenario.encoders.bits_per_turn = draw.whole(17, 20);
    scenario.derivatives = {10, 40, 40, 6.3 / std::exp2(scenario.encoders.bits_per_turn)};
    if (kind.outputs == OutputKind::wrench) {
        scenario.force_torque.emplace();
        scenario.force_torque->range << 1500, 1500, 2000, 35, 35, 25;
        scenario.force_torque->noise << 0.25, 0.25, 0.25, 0.005, 0.005, 0.005;
        scenario.force_torque->bandwidth_hz = 100;
    }
    return scenario;
}

void attach_payload(ChangeCase& one, const ChangeArm& arm, Scenario& scenario, Draw& draw) {
    Payload payload;
    payload.attached_s = one.time_s;
    payload.mass = draw.uniform(arm.payload_from, arm.payload_to);
    for (double& c : payload.centre) {
        c = draw.uniform(-0.05, 0.05);
    }
    scenario.payloads.push_back(payload);
    one.where = "tool";
    one.size = formatted("%.2f kg", payload.mass);
}

/// Time of the simulation (s), shared with everything that changes during it.
using Clock = std::shared_ptr<double>;

/// Adds friction of further seals and bearings to the bristles' friction. It reverses its sign within 0.01
/// rad/s.
void change_friction(ChangeCase& one, Scenario& scenario, const Clock& clock, Draw& draw) {
    const std::size_t joint = draw.below(scenario.actuators.friction.size());
    const LuGreParameters& before = scenario.actuators.friction[joint];
    const double factor = draw.uniform(1.5, 3);
    const auto more = factor - 1;
    scenario.loads.further = [=, at_s = one.time_s](const JointVector& position,
                                                    const JointVector& velocity) {
        JointVector torque = JointVector::Zero(position.size());
        const auto k = static_cast<Eigen::Index>(joint);
        const double level = before.coulomb * std::tanh(velocity[k] / 0.005) + before.viscous * velocity[k];
        torque[k] = *clock >= at_s ? -more * level : 0;
        return torque;
    };
    one.where = "joint" + std::to_string(joint + 1);
    one.size = formatted("x %.2f", factor);
}

void push(ChangeCase& one, const ChangeArm& arm, Scenario& scenario, Draw& draw) {
    Contact contact;
    contact.start_s = one.time_s;
    contact.end_s = one.end_s = one.time_s + draw.uniform(0.6, 2);
    Eigen::Vector3d direction(draw.uniform(-1, 1), draw.uniform(-1, 1), draw.uniform(-1, 1));
    contact.force = draw.uniform(arm.push_from, arm.push_to) * direction.normalized();
    scenario.loads.contacts.push_back(contact);
    one.where = scenario.force_torque ? "ft_sensor" : "tool";
    one.size =
        formatted("%.0f N", contact.force.norm()) + formatted(" for %.1f s", contact.end_s - contact.start_s);
}

double& element(Columns& columns, std::size_t row, std::size_t column) {
    return columns.values[row * columns.names.size() + column];
}

std::size_t row_at(const ChangeCase& one) {
    const auto& times = one.recording.time_s;
    return static_cast<std::size_t>(std::ranges::lower_bound(times, one.time_s) - times.begin());
}

void move_bias(ChangeCase& one, const ChangeArm& arm, bool wrench, Draw& draw) {
    Columns& output = one.recording.output;
    const std::size_t first = draw.below(output.names.size());
    const std::size_t count = wrench ? draw.below(3) + 1 : 1;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t k = (first + i) % output.names.size();
        const double unit = wrench ? (k < 3 ? 1 : 0.05) : arm.coulomb * arm.joint_share[k] / 2;
        const double moved = draw.sign() * unit * draw.uniform(1, 3);
        for (std::size_t row = row_at(one); row < one.recording.time_s.size(); ++row) {
            element(output, row, k) += moved;
        }
        one.size += output.names[k] + formatted(" %.2f ", moved);
    }
    one.where = wrench ? "ft_sensor" : "joint" + std::to_string(first + 1);
}

void freeze(ChangeCase& one, Draw& draw) {
    const std::size_t joints = one.recording.position.names.size();
    const std::size_t channel = draw.below(joints + one.recording.output.names.size());
    Columns& columns = channel < joints ? one.recording.position : one.recording.output;
    const std::size_t column = channel < joints ? channel : channel - joints;
    const std::size_t from = row_at(one);
    for (std::size_t row = from; row < one.recording.time_s.size(); ++row) {
        element(columns, row, column) = element(columns, from, column);
    }
    one.where = channel < joints ? "encoder" + std::to_string(channel + 1) : columns.names[column];
}

Recording simulate_rows(const PanelRobot& kind, const Robot& robot, const Scenario& scenario,
                        const Clock& clock) {
    Simulation simulation(robot, scenario);
    Recording recording;
    recording.source = "change panel";
    recording.position.names = joint_names("q", robot.joints.size());
    recording.output.names = output_names(kind.outputs, robot.joints.size());
    for (std::size_t row = 0; row < scenario.recording.samples; ++row) {
        *clock = static_cast<double>(row) / change_rate_hz;
        const SimulatedSample sample = simulation.next();
        if (kind.outputs == OutputKind::wrench) {
            append_row(recording, sample.time_s, sample.position, sample.wrench);
        } else {
            append_row(recording, sample.time_s, sample.position, sample.torque);
        }
    }
    return recording;
}

/// The part of the recording that is used for training.
Recording beginning(Recording recording) {
    const auto rows = static_cast<std::size_t>(trained_s * change_rate_hz);
    recording.time_s.resize(rows);
    recording.time_ns.resize(rows);
    recording.gap_before.resize(rows);
    recording.position.values.resize(rows * recording.position.names.size());
    recording.output.values.resize(rows * recording.output.names.size());
    return recording;
}

/// A sensor in the arm does not measure joint friction, so friction changes are left out for wrenches.
std::vector<Cause> causes_of(bool wrench) {
    std::vector<Cause> causes{Cause::payload, Cause::bias, Cause::contact, Cause::frozen};
    if (!wrench) {
        causes.push_back(Cause::friction);
    }
    return causes;
}

void change(ChangeCase& one, const ChangeArm& arm, Scenario& scenario, const Clock& clock, Draw& draw) {
    switch (*one.cause) {
    case Cause::payload:
        return attach_payload(one, arm, scenario, draw);
    case Cause::friction:
        return change_friction(one, scenario, clock, draw);
    case Cause::contact:
        return push(one, arm, scenario, draw);
    default:
        return; // applied to the recording
    }
}

} // namespace

const std::vector<std::string>& change_robot_names() {
    static const std::vector<std::string> names{"ur5_torque", "icub_wrench", "three_joint_torque"};
    return names;
}

ChangeCase make_change_case(std::uint64_t seed, const ChangeMix& mix) {
    Draw draw(seed, 11);
    ChangeCase one;
    one.seed = seed;
    const std::string& robot_name = draw.of(change_robot_names());
    one.robot_name = mix.robot.value_or(robot_name);
    const PanelRobot& kind = panel_robot(one.robot_name);
    const bool wrench = kind.outputs == OutputKind::wrench;
    const Cause drawn = draw.of(causes_of(wrench));
    if (!mix.never) {
        one.cause = mix.cause.value_or(drawn);
    }
    one.time_s = draw.uniform(earliest_s, mix.duration_s - 20);
    one.end_s = mix.duration_s;
    const Robot robot = read_panel_robot(kind);
    Scenario scenario = change_scenario(kind, robot, mix.duration_s, draw);
    const ChangeArm& arm = change_arm(one.robot_name);
    const auto clock = std::make_shared<double>(0);
    if (one.cause) {
        change(one, arm, scenario, clock, draw);
    }
    one.recording = simulate_rows(kind, robot, scenario, clock);
    if (one.cause == Cause::bias) {
        move_bias(one, arm, wrench, draw);
    } else if (one.cause == Cause::frozen) {
        freeze(one, draw);
    }
    return one;
}

ChangeModel train_change_model(const ChangeCase& one) {
    const PanelRobot& kind = panel_robot(one.robot_name);
    const Robot robot = read_panel_robot(kind);
    ModelTraining training;
    TrainingOptions& options = training.options;
    options.model = &structures::P;
    options.input = InputKind::DFSR;
    options.lags = 12;
    options.likelihood_rows = 400;
    options.starts = 3;
    options.refinement_evaluations = 0;
    options.forgetting_factor = 0.9998;
    std::vector<std::string> effects{"ft_bias"};
    if (kind.outputs != OutputKind::wrench) {
        effects = {"viscous_friction", "coulomb_friction", "rotor_inertia", "torque_offset"};
    }
    training.physics = RobotPhysics{robot, effects, 0.05, {}};
    const std::vector<Recording> recordings{beginning(one.recording)};
    ChangeModel result;
    result.model = train_model(prepare_training(recordings, training), kind.outputs, training, {}).model;
    calibrate_innovation_limit(result.model, recordings);
    result.monitor = monitor_setup(result.model, &robot, one.robot_name);
    return result;
}

} // namespace dfdyn::tests
