// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidate_parts.hpp"
#include "tools/diagnosis/candidates.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

/// The outputs along the measured motion but for `joint`, whose true position is by `change` another.
Eigen::MatrixXd moved_outputs(const DiagnosisSignals& signals, std::size_t joint,
                              const Eigen::VectorXd& change) {
    const auto index = static_cast<Eigen::Index>(joint);
    RobotMotion motion = signals.measured.motion;
    const Eigen::VectorXd velocity = signals.rate(change);
    motion.position.col(index) += change;
    motion.velocity.col(index) += velocity;
    motion.acceleration.col(index) += signals.rate(velocity);
    return rigid_outputs(signals.robot, signals.kind, motion);
}

/// About an offset: with it as coefficient, the column is what it brings, exactly.
Candidate offset(const DiagnosisSignals& signals, std::size_t joint, double angle) {
    const double reference = at_least_small(angle);
    const Eigen::VectorXd everywhere = Eigen::VectorXd::Constant(signals.rows(), reference);
    Candidate result =
        single_column("encoder_offset", numbered("encoder", joint),
                      on_outputs((moved_outputs(signals, joint, -everywhere) - signals.nominal) / reference),
                      up_to(0.6), "offset", "rad");
    result.about = [&signals, joint](const EffectShape&, const Eigen::VectorXd& coefficients) {
        return offset(signals, joint, coefficients[0]);
    };
    return result;
}

/// About an amplitude of sine and cosine, likewise.
Candidate eccentricity(const DiagnosisSignals& signals, std::size_t joint, double sine, double cosine) {
    const Eigen::ArrayXd measured = signals.measured.motion.position.col(static_cast<Eigen::Index>(joint));
    const double along_sine = at_least_small(sine);
    const double along_cosine = at_least_small(cosine);
    // measured = true + sine sin(true) + cosine cos(true)
    Eigen::ArrayXd position = measured;
    for (int repetition = 0; repetition < 6; ++repetition) {
        position = measured - along_sine * position.sin() - along_cosine * position.cos();
    }
    const Eigen::MatrixXd first = moved_outputs(signals, joint, -along_sine * position.sin().matrix());
    const Eigen::MatrixXd both = moved_outputs(signals, joint, (position - measured).matrix());
    Candidate result;
    result.effect = "encoder_eccentricity";
    result.where = numbered("encoder", joint);
    result.columns = {on_outputs((first - signals.nominal) / along_sine),
                      on_outputs((both - first) / along_cosine)};
    result.shapes = {whole_shape(result, up_to(0.3))};
    result.about = [&signals, joint](const EffectShape&, const Eigen::VectorXd& coefficients) {
        return eccentricity(signals, joint, coefficients[0], coefficients[1]);
    };
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector<EffectParameter>{{"amplitude", "rad", coefficients.norm()},
                                            {"phase", "rad", std::atan2(coefficients[1], coefficients[0])}};
    };
    return result;
}

/// Low-passed at `share` of where the joint's position was: accelerations of it are to be taken.
Eigen::VectorXd smooth(const DiagnosisSignals& signals, std::size_t joint, const Eigen::VectorXd& series,
                       double share) {
    return signals.below(share * signals.measured.smoothing_hz[static_cast<Eigen::Index>(joint)], series);
}

/// How far a link is off its motor while it is carried on one flank of its gear's teeth, falls through the
/// gap where its load turns over, and is caught by the other flank without springing back. T, rad.
Eigen::VectorXd travel_in_gap(const DiagnosisSignals& signals, Eigen::Index joint, double gap) {
    constexpr int substeps = 8;
    const double step_s = 1 / (substeps * signals.measured.rate_hz);
    const Eigen::VectorXd acceleration =
        -signals.joint_torque.col(joint).cwiseQuotient(signals.joint_inertia.col(joint));
    Eigen::VectorXd travel(signals.rows());
    for (const Stretch& stretch : signals.measured.stretches) {
        double position = std::copysign(gap / 2, acceleration[stretch.first]);
        double velocity = 0;
        for (Eigen::Index row = stretch.first; row < stretch.first + stretch.count; ++row) {
            for (int substep = 0; substep < substeps; ++substep) {
                velocity += acceleration[row] * step_s;
                position += velocity * step_s;
                if (std::abs(position) >= gap / 2) {
                    position = std::copysign(gap / 2, position);
                    velocity = 0;
                }
            }
            travel[row] = position;
        }
    }
    return travel;
}

} // namespace

Eigen::MatrixXd play_course(const DiagnosisSignals& signals, std::size_t joint, double gap) {
    constexpr double sure_hz = 7; // how hard the flanks hit each other, nobody knows
    const auto index = static_cast<Eigen::Index>(joint);
    const Eigen::VectorXd travel = travel_in_gap(signals, index, gap) / gap;
    return signals.of_position(
        joint, smooth(signals, joint, travel, std::min(1.0, sure_hz / signals.measured.smoothing_hz[index])));
}

Candidate backlash_candidate(const DiagnosisSignals& signals, std::size_t joint,
                             const std::vector<double>& gaps) {
    Candidate result;
    result.effect = "backlash";
    result.where = numbered("joint", joint);
    for (const double gap : gaps) {
        const auto allowed = [gap](const Eigen::VectorXd& coefficients) {
            constexpr double least = 0.25; // only the link's share of the joint's inertia is caught
            constexpr double most = 1.8;
            return coefficients[0] > least * gap && coefficients[0] < most * gap;
        };
        result.shapes.push_back({{result.columns.size()}, allowed, gap});
        result.columns.push_back(on_outputs(play_course(signals, joint, gap)));
    }
    // the course tells the gap: how long the link falls; not the coefficient, which is how hard it is caught
    result.parameters = [](const Eigen::VectorXd&, const EffectShape& shape) {
        // a rotor falls otherwise than the whole joint, by a share that nobody knows: simulated gears come
        // out up to 13 % too wide
        constexpr double unsettled = 0.08;
        return std::vector<EffectParameter>{{"gap", "rad", shape.value, 0, unsettled}};
    };
    result.about = [&signals, joint](const EffectShape& shape, const Eigen::VectorXd&) {
        const double found = shape.value;
        return backlash_candidate(signals, joint,
                                  {found, found / 1.12, found / 1.04, found * 1.04, found * 1.12});
    };
    return result;
}

std::vector<Candidate> position_candidates(const DiagnosisSignals& signals) {
    std::vector<Candidate> result;
    for (std::size_t joint = 0; joint < signals.joints(); ++joint) {
        const std::string where = numbered("joint", joint);
        const auto index = static_cast<Eigen::Index>(joint);
        result.push_back(offset(signals, joint, 0));
        result.push_back(eccentricity(signals, joint, 0, 0));
        Candidate flexibility =
            single_column("joint_flexibility", where,
                          on_outputs(signals.of_position(
                              joint, -smooth(signals, joint, signals.joint_torque.col(index), 0.5))),
                          is_positive);
        flexibility.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
            return std::vector<EffectParameter>{{"stiffness", "N·m/rad", 1 / coefficients[0]}};
        };
        result.push_back(std::move(flexibility));
    }
    return result;
}

} // namespace dfdyn::tools
