// SPDX-License-Identifier: Apache-2.0
// Compares simulated effects of bodies, mounting and sensors with the name, unit and sign of their
// parameters.
#include "tests/diagnosis/effect_trial.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/seed.hpp"
#include "tools/robot/dynamics/arm_dynamics.hpp"

#include <cmath>
#include <numbers>

namespace {

using namespace dfdyn::tests;
using namespace dfdyn::tools;

JointVector rigid(const Robot& robot, const SimulatedTruth& truth) {
    const ArmDynamics dynamics(robot, JointVector::Zero(truth.position.size()));
    ArmDynamics::Configuration configuration;
    dynamics.configure(truth.position, configuration);
    return dynamics.inverse(configuration, truth.velocity, truth.acceleration);
}

Wrench rigid_wrench(const Robot& robot, const SimulatedTruth& truth) {
    const ArmDynamics dynamics(robot, JointVector::Zero(truth.position.size()));
    ArmDynamics::Configuration configuration;
    dynamics.configure(truth.position, configuration);
    return dynamics.wrench(configuration, truth.velocity, truth.acceleration);
}

std::vector<Eigen::Isometry3d> places(const Robot& robot, const JointVector& position) {
    std::vector<Eigen::Isometry3d> result;
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    for (std::size_t i = 0; i < robot.joints.size(); ++i) {
        place = place * robot.joints[i].placement *
                Eigen::AngleAxisd(position[static_cast<Eigen::Index>(i)], robot.joints[i].axis);
        result.push_back(place);
    }
    return result;
}

/// Joint torques that a point mass at `point` of link `link` needs for its weight and inertia, by
/// d'Alembert's principle. Accelerations are differences of the point's positions shortly before and after.
JointVector point_mass_torque(const Robot& robot, const SimulatedTruth& truth, std::size_t link, double mass,
                              const Eigen::Vector3d& point) {
    constexpr double h = 1e-4;
    const auto at = [&](double time) {
        const JointVector q = truth.position + time * truth.velocity + time * time / 2 * truth.acceleration;
        return Eigen::Vector3d(places(robot, q)[link] * point);
    };
    const Eigen::Vector3d acceleration = (at(h) - 2 * at(0) + at(-h)) / (h * h);
    const Eigen::Vector3d force = mass * (acceleration - robot.gravity);
    JointVector torque = JointVector::Zero(truth.position.size());
    const std::vector<Eigen::Isometry3d> place = places(robot, truth.position);
    for (std::size_t i = 0; i <= link; ++i) {
        const Eigen::Vector3d axis = place[i].linear() * robot.joints[i].axis;
        torque[static_cast<Eigen::Index>(i)] = axis.cross(at(0) - place[i].translation()).dot(force);
    }
    return torque;
}

template <class Expected>
void check_torque_addition(const EffectTrial& trial, double margin, const Expected& expected) {
    CAPTURE(trial.setup.kind.name, trial.effect.where, trial.size);
    for (std::size_t row = 0; row < trial.samples.size(); row += 5) {
        const SimulatedSample& sample = trial.samples[row];
        const JointVector added = sample.torque - rigid(trial.setup.robot, sample.truth);
        REQUIRE((added - expected(sample)).cwiseAbs().maxCoeff() < margin);
    }
}

/// Compares each wrench reading with `expected`, a function of the true wrench.
template <class Expected>
void check_reading(const EffectTrial& trial, const Expected& expected) {
    CAPTURE(trial.size);
    for (const SimulatedSample& sample : trial.samples) {
        const Wrench truth = rigid_wrench(trial.setup.robot, sample.truth);
        REQUIRE((sample.wrench - expected(truth, sample)).head(3).cwiseAbs().maxCoeff() < 2e-3);
        REQUIRE((sample.wrench - expected(truth, sample)).tail(3).cwiseAbs().maxCoeff() < 2e-4);
    }
}

const char* const axes[] = {"fx", "fy", "fz", "mx", "my", "mz"};

Wrench six(const EffectTrial& trial) {
    Wrench result;
    for (Eigen::Index axis = 0; axis < 6; ++axis) {
        result[axis] = trial.parameter(axes[axis]);
    }
    return result;
}

} // namespace

TEST_CASE("a payload is a point mass in the tip's frame from the time at which it is attached") {
    for (std::uint64_t trial_seed = seed(); trial_seed < seed() + 3; ++trial_seed) {
        const EffectTrial trial = try_effect("payload", "ur5_torque", trial_seed);
        const Robot& robot = trial.setup.robot;
        const Eigen::Vector3d centre(trial.parameter("com_x"), trial.parameter("com_y"),
                                     trial.parameter("com_z"));
        check_torque_addition(trial, 2e-3 * trial.parameter("mass") + 1e-4,
                              [&](const SimulatedSample& sample) {
                                  if (sample.truth.time_s < trial.parameter("attached")) {
                                      return JointVector(JointVector::Zero(6));
                                  }
                                  return point_mass_torque(robot, sample.truth, 5, trial.parameter("mass"),
                                                           robot.tip_placement * centre);
                              });
    }
}

TEST_CASE("a link's error is true minus nominal mass at the centre of mass or a displaced centre") {
    for (std::uint64_t trial_seed = seed(); trial_seed < seed() + 4; ++trial_seed) {
        const EffectTrial trial = try_effect("link_inertia_error", "three_joint_torque", trial_seed);
        const Robot& robot = trial.setup.robot;
        const auto link = static_cast<std::size_t>(trial.joint());
        const InertialParameters& body = robot.joints[link].inertia;
        const Eigen::Vector3d centre = body.segment<3>(1) / body[0];
        const Eigen::Vector3d moved =
            centre + Eigen::Vector3d(trial.parameter("delta_com_x"), trial.parameter("delta_com_y"),
                                     trial.parameter("delta_com_z"));
        const double mass = body[0] + trial.parameter("delta_mass");
        check_torque_addition(trial, 1e-3, [&](const SimulatedSample& sample) {
            return JointVector(point_mass_torque(robot, sample.truth, link, mass, moved) -
                               point_mass_torque(robot, sample.truth, link, body[0], centre));
        });
    }
}

TEST_CASE("a link's rotational inertia error is true minus nominal inertia about the centre of mass") {
    for (std::uint64_t trial_seed = seed(); trial_seed < seed() + 4; ++trial_seed) {
        const EffectTrial trial =
            try_effect("link_rotational_inertia_error", "three_joint_torque", trial_seed);
        const auto link = static_cast<std::size_t>(trial.joint());
        const InertialParameters& body = trial.setup.robot.joints[link].inertia;
        const Eigen::Vector3d centre = body.segment<3>(1) / body[0];
        const Eigen::Vector3d inertia(trial.parameter("delta_ixx"), trial.parameter("delta_iyy"),
                                      trial.parameter("delta_izz"));
        const Eigen::Vector3d second_moments = (inertia.sum() / 2 - inertia.array()).matrix();
        check_torque_addition(trial, 1e-3, [&](const SimulatedSample& sample) {
            // as two point masses on each axis, whose mass is taken off at the centre
            constexpr double distance = 0.1;
            JointVector torque = JointVector::Zero(sample.truth.position.size());
            for (Eigen::Index axis = 0; axis < 3; ++axis) {
                const double mass = second_moments[axis] / (2 * distance * distance);
                for (const double part : {-1.0, 0.0, 1.0}) {
                    torque +=
                        point_mass_torque(trial.setup.robot, sample.truth, link, part == 0 ? -2 * mass : mass,
                                          centre + part * distance * Eigen::Vector3d::Unit(axis));
                }
            }
            return torque;
        });
    }
}

TEST_CASE("a tilt rotates the base by tilt_x and then by tilt_y about the root's axes") {
    const EffectTrial trial = try_effect("gravity_tilt", "three_joint_torque", seed());
    Robot tilted = trial.setup.robot;
    // The whole arm is rotated under the same gravity.
    tilted.joints.front().placement = Eigen::AngleAxisd(trial.parameter("tilt_y"), Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(trial.parameter("tilt_x"), Eigen::Vector3d::UnitX()) *
                                      tilted.joints.front().placement;
    check_torque_addition(trial, 1e-8, [&](const SimulatedSample& sample) {
        return JointVector(rigid(tilted, sample.truth) - rigid(trial.setup.robot, sample.truth));
    });
}

TEST_CASE("an encoder's offset is measured minus true position") {
    const EffectTrial trial = try_effect("encoder_offset", "ur5_torque", seed());
    for (const SimulatedSample& sample : trial.samples) {
        JointVector expected = sample.truth.position;
        expected[trial.joint()] += trial.parameter("offset");
        REQUIRE((sample.position - expected).cwiseAbs().maxCoeff() < 1e-7);
        REQUIRE((sample.torque - rigid(trial.setup.robot, sample.truth)).cwiseAbs().maxCoeff() < 1e-8);
    }
}

TEST_CASE("an eccentric encoder adds a sine of the position to its reading") {
    const EffectTrial trial = try_effect("encoder_eccentricity", "ur5_torque", seed());
    for (const SimulatedSample& sample : trial.samples) {
        const double q = sample.truth.position[trial.joint()];
        REQUIRE(
            sample.position[trial.joint()] ==
            Approx(q + trial.parameter("amplitude") * std::sin(q + trial.parameter("phase"))).margin(1e-7));
    }
}

TEST_CASE("the bias and the drift of an F/T sensor are added to its reading") {
    const EffectTrial biased = try_effect("ft_bias", "icub_wrench", seed());
    check_reading(biased,
                  [&](const Wrench& truth, const SimulatedSample&) { return Wrench(truth + six(biased)); });
    const EffectTrial drifting = try_effect("ft_drift", "icub_wrench", seed());
    check_reading(drifting, [&](const Wrench& truth, const SimulatedSample& sample) {
        return Wrench(truth + sample.time_s * six(drifting));
    });
}

TEST_CASE("the gain and the crosstalk of an F/T sensor multiply the true wrench") {
    const EffectTrial gain = try_effect("ft_gain", "icub_wrench", seed());
    check_reading(gain, [&](Wrench wrench, const SimulatedSample&) {
        wrench[static_cast<Eigen::Index>(gain.parameter("axis"))] *= gain.parameter("gain");
        return wrench;
    });
    const EffectTrial crosstalk = try_effect("ft_crosstalk", "icub_wrench", seed());
    check_reading(crosstalk, [&](Wrench wrench, const SimulatedSample&) {
        wrench[static_cast<Eigen::Index>(crosstalk.parameter("to_axis"))] +=
            crosstalk.parameter("gain") * wrench[static_cast<Eigen::Index>(crosstalk.parameter("from_axis"))];
        return wrench;
    });
}

TEST_CASE("a misaligned F/T sensor measures the true wrench rotated by roll and pitch and yaw") {
    const EffectTrial trial = try_effect("ft_rotation", "icub_wrench", seed());
    const double r = trial.parameter("roll");
    const double p = trial.parameter("pitch");
    const double y = trial.parameter("yaw");
    Eigen::Matrix3d turn; // the rotation matrix as URDF defines it
    turn << std::cos(y) * std::cos(p), std::cos(y) * std::sin(p) * std::sin(r) - std::sin(y) * std::cos(r),
        std::cos(y) * std::sin(p) * std::cos(r) + std::sin(y) * std::sin(r), std::sin(y) * std::cos(p),
        std::sin(y) * std::sin(p) * std::sin(r) + std::cos(y) * std::cos(r),
        std::sin(y) * std::sin(p) * std::cos(r) - std::cos(y) * std::sin(r), -std::sin(p),
        std::cos(p) * std::sin(r), std::cos(p) * std::cos(r);
    check_reading(trial, [&](const Wrench& truth, const SimulatedSample&) {
        Wrench turned;
        turned << turn * truth.head<3>(), turn * truth.tail<3>();
        return turned;
    });
}

TEST_CASE("a delayed F/T sensor measures the past wrench") {
    const EffectTrial trial = try_effect("delay", "icub_wrench", seed(), 1000);
    const double delay = trial.parameter("delay");
    CHECK(delay > 0);
    for (std::size_t row = 1000; row < 6000; row += 7) {
        const double then = static_cast<double>(row) - delay * 1000;
        const auto before = static_cast<std::size_t>(then);
        const double share = then - std::floor(then);
        const Wrench expected =
            (1 - share) * trial.samples[before].truth.wrench + share * trial.samples[before + 1].truth.wrench;
        REQUIRE((trial.samples[row].wrench - expected).cwiseAbs().maxCoeff() < 5e-3);
    }
}

TEST_CASE("a push at the tip is the force of the surroundings and reaches the base side of the sensor") {
    const EffectTrial trial = try_effect("external_contact", "icub_wrench", seed());
    const Robot& robot = trial.setup.robot;
    const Eigen::Vector3d direction(trial.parameter("base_x"), trial.parameter("base_y"),
                                    trial.parameter("base_z"));
    const double start = trial.parameter("start");
    const double end = trial.parameter("end");
    check_reading(trial, [&](const Wrench& truth, const SimulatedSample& sample) {
        const double along = (sample.truth.time_s - start) / (end - start);
        const double wave = along > 0 && along < 1 ? std::sin(std::numbers::pi * along) : 0;
        const Eigen::Vector3d force = trial.parameter("peak") * wave * wave * direction;
        const std::vector<Eigen::Isometry3d> place = places(robot, sample.truth.position);
        const Eigen::Isometry3d sensor = place[robot.sensor->link - 1] * robot.sensor->placement;
        const Eigen::Vector3d lever = sample.truth.tip - sensor.translation();
        Wrench passed; // child to parent
        passed << sensor.linear().transpose() * force, sensor.linear().transpose() * lever.cross(force);
        return Wrench(truth + (robot.sensor->parent_to_child ? -passed : passed));
    });
}
