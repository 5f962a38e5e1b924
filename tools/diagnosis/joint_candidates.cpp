// SPDX-License-Identifier: Apache-2.0
#include "tools/common/root_mean_square.hpp"
#include "tools/diagnosis/candidate_parts.hpp"
#include "tools/diagnosis/candidates.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

/// What the effects of one joint are made of; velocity, direction: per row.
struct JointSignals {
    const DiagnosisSignals& all;
    std::size_t joint;
    std::string where;
    Eigen::Index output;
    Eigen::VectorXd position, velocity, direction;

    JointSignals(const DiagnosisSignals& signals, std::size_t number)
        : all(signals), joint(number), where(numbered("joint", number)),
          output(static_cast<Eigen::Index>(number)), position(signals.measured.motion.position.col(output)),
          velocity(signals.measured.motion.velocity.col(output)), direction(signals.direction(output)) {}

    Candidate candidate(const char* effect) const {
        Candidate result;
        result.effect = effect;
        result.where = where;
        return result;
    }
    EffectColumn column(Eigen::VectorXd series) const { return on_output(output, std::move(series)); }
};

Candidate viscous(const JointSignals& joint) {
    return single_column("viscous_friction", joint.where, joint.column(joint.velocity), is_positive,
                         "viscous", "N·m·s/rad");
}

/// Dahl's friction that builds up to `level` (T) over `distance` (rad) where that is 1, by the same stiffness
/// where it is not: df/dq = (1 - f sgn q' / level) / distance, exact for steps of constant direction (P. R.
/// Dahl, "A solid friction model", 1968).
Eigen::VectorXd dahl(const JointSignals& joint, double distance, const Eigen::VectorXd& level) {
    constexpr double least = 1e-9; // no level at all would divide by it
    Eigen::VectorXd friction(joint.position.size());
    for (const Stretch& stretch : joint.all.measured.stretches) {
        double state = 0;
        friction[stretch.first] = 0;
        for (Eigen::Index row = stretch.first + 1; row < stretch.first + stretch.count; ++row) {
            const double step = joint.position[row] - joint.position[row - 1];
            const double highest = std::max(level[row], least);
            const double settled = std::copysign(highest, step);
            state = settled + (state - settled) * std::exp(-std::abs(step) / (distance * highest));
            friction[row] = state;
        }
    }
    return friction;
}

Eigen::VectorXd dahl(const JointSignals& joint, double distance) {
    return dahl(joint, distance, Eigen::VectorXd::Ones(joint.position.size()));
}

constexpr double shortest_presliding = 3e-3; // rad; what builds up over less is called Coulomb friction

/// Which way a joint slides, in columns 0 to 2 of Coulomb's and Stribeck's friction: by its velocity, or by
/// its travel, which keeps the direction where the joint stands.
std::vector<Eigen::VectorXd> directions(const JointSignals& joint) {
    return {joint.direction, dahl(joint, shortest_presliding / 8), dahl(joint, shortest_presliding / 3)};
}

Candidate coulomb(const JointSignals& joint) {
    Candidate result = joint.candidate("coulomb_friction");
    result.family = "sliding at " + joint.where;
    for (Eigen::VectorXd& direction : directions(joint)) {
        result.shapes.push_back({{result.columns.size()}, is_positive, 0});
        result.columns.push_back(joint.column(std::move(direction)));
    }
    result.columns.push_back(joint.column(joint.direction.array().square().matrix()));
    for (std::size_t i = 0; i < 3; ++i) {
        result.shapes.push_back({{i, 3}, first_is_positive, 0});
    }
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        if (shape.columns.size() == 1) {
            return std::vector<EffectParameter>{{"coulomb", "N·m", coefficients[0]}};
        }
        return std::vector<EffectParameter>{{"coulomb_pos", "N·m", coefficients[0] + coefficients[1]},
                                            {"coulomb_neg", "N·m", coefficients[0] - coefficients[1]}};
    };
    return result;
}

/// Static friction that is a tenth and more above Coulomb's: less is no effect of its own, but how far a
/// model of Coulomb's friction is wrong.
bool is_stribeck(const Eigen::VectorXd& coefficients) {
    constexpr double least_excess = 0.1;
    return coefficients[0] > 0 && coefficients[1] >= least_excess * coefficients[0];
}

Candidate stribeck(const JointSignals& joint) {
    Candidate result = joint.candidate("stribeck_friction");
    result.family = "sliding at " + joint.where;
    const std::vector<Eigen::VectorXd> sliding = directions(joint);
    const auto faded = [sliding, joint](std::size_t direction, double stribeck_velocity) {
        return joint.column(sliding[direction].array() *
                            (-(joint.velocity.array() / stribeck_velocity).square()).exp());
    };
    for (const Eigen::VectorXd& direction : sliding) {
        result.columns.push_back(joint.column(direction));
    }
    const double slowest = joint.all.sign_velocity[joint.output];
    for (const double stribeck_velocity : {0.01, 0.02, 0.04, 0.08, 0.16, 0.32}) {
        for (std::size_t i = 0; i < sliding.size() && stribeck_velocity > 1.5 * slowest; ++i) {
            result.shapes.push_back({{i, result.columns.size()}, is_stribeck, stribeck_velocity});
            result.columns.push_back(faded(i, stribeck_velocity));
        }
    }
    result.at_value = [faded](const EffectShape& shape, double value) {
        return faded(shape.columns.front(), value);
    };
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        return std::vector<EffectParameter>{{"coulomb", "N·m", coefficients[0]},
                                            {"static", "N·m", coefficients[0] + coefficients[1]},
                                            {"stribeck_velocity", "rad/s", shape.value}};
    };
    return result;
}

Candidate presliding(const JointSignals& joint) {
    Candidate result = joint.candidate("presliding_hysteresis");
    result.family = "sliding at " + joint.where;
    for (double distance = 1.4 * shortest_presliding; distance < 0.3; distance *= 1.7) {
        result.shapes.push_back({{result.columns.size()}, is_positive, distance});
        result.columns.push_back(joint.column(dahl(joint, distance)));
    }
    result.at_value = [joint](const EffectShape& /*shape*/, double distance) {
        return joint.column(dahl(joint, distance));
    };
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        return std::vector<EffectParameter>{{"stiffness", "N·m/rad", coefficients[0] / shape.value},
                                            {"break_away", "N·m", coefficients[0]}};
    };
    return result;
}

/// Its shapes: over which distance it builds up at the load's rms.
Candidate load_dependent(const JointSignals& joint) {
    const Eigen::VectorXd load = joint.all.joint_torque.col(joint.output).cwiseAbs();
    const double usual = std::max(root_mean_square(load), 1e-9);
    const auto column = [load, usual, joint](double distance) {
        return joint.column(usual * dahl(joint, distance, load / usual));
    };
    Candidate result = joint.candidate("load_dependent_friction");
    for (const double distance : {1.0 / 8, 1.0 / 3, 1.0, 3.0, 9.0}) {
        result.shapes.push_back({{result.columns.size()}, positive_up_to(1), distance * shortest_presliding});
        result.columns.push_back(column(distance * shortest_presliding));
    }
    result.at_value = [column](const EffectShape& /*shape*/, double distance) { return column(distance); };
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector<EffectParameter>{{"mu", "1", coefficients[0]}};
    };
    return result;
}

Candidate spring(const JointSignals& joint) {
    Candidate result = joint.candidate("joint_spring");
    result.columns = {joint.column(joint.position),
                      joint.column(Eigen::VectorXd::Ones(joint.position.size()))};
    result.shapes = {{{0, 1}, first_is_positive, 0}};
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector<EffectParameter>{{"stiffness", "N·m/rad", coefficients[0]},
                                            {"rest", "rad", -coefficients[1] / coefficients[0]}};
    };
    return result;
}

} // namespace

std::vector<Candidate> joint_candidates(const DiagnosisSignals& signals) {
    std::vector<Candidate> result;
    if (signals.wrench()) {
        return result;
    }
    for (std::size_t number = 0; number < signals.joints(); ++number) {
        const JointSignals joint(signals, number);
        result.push_back(viscous(joint));
        result.push_back(coulomb(joint));
        result.push_back(stribeck(joint));
        result.push_back(presliding(joint));
        result.push_back(spring(joint));
        result.push_back(load_dependent(joint));
        result.push_back(single_column("torque_offset", joint.where,
                                       joint.column(Eigen::VectorXd::Ones(signals.rows())), is_anything,
                                       "offset", "N·m"));
        result.push_back(single_column("rotor_inertia", joint.where,
                                       joint.column(signals.measured.motion.acceleration.col(joint.output)),
                                       is_positive, "inertia", "kg·m²"));
    }
    return result;
}

Candidate ripple_candidate(const DiagnosisSignals& signals, std::size_t number,
                           const std::vector<int>& cycles) {
    const JointSignals joint(signals, number);
    Candidate result = joint.candidate("torque_ripple");
    for (const int count : cycles) {
        const Eigen::ArrayXd angle = joint.position.array() * count;
        result.shapes.push_back(
            {{result.columns.size(), result.columns.size() + 1}, is_anything, static_cast<double>(count)});
        result.columns.push_back(joint.column(angle.sin()));
        result.columns.push_back(joint.column(angle.cos()));
    }
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        return std::vector<EffectParameter>{{"amplitude", "N·m", coefficients.norm()},
                                            {"cycles_per_rev", "1", shape.value},
                                            {"phase", "rad", std::atan2(coefficients[1], coefficients[0])}};
    };
    return result;
}

std::vector<Candidate> drift_candidates(const DiagnosisSignals& signals, const Eigen::MatrixXd& friction) {
    std::vector<Candidate> result;
    const Eigen::VectorXd elapsed = signals.measured.time_s.array() - signals.measured.time_s[0];
    for (Eigen::Index joint = 0; joint < friction.cols(); ++joint) {
        if (friction.col(joint).any()) {
            result.push_back(single_column(
                "friction_drift", numbered("joint", static_cast<std::size_t>(joint)),
                on_output(joint, friction.col(joint).cwiseProduct(elapsed)), is_anything, "rate", "1/s"));
        }
    }
    return result;
}

} // namespace dfdyn::tools
