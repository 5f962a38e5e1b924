// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/candidates/effect_regression.hpp"
#include "tools/diagnosis/candidates/true_position.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/effects/effect_internals.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

// Relative model error of a gap with impacts: the link's share of the joint's motion in the gap is uncertain.
// For simulated gears the estimated gap is up to 13 % too wide.
constexpr ParameterKind backlash_gap{"gap", "rad", 0, 0.08};
// Without impacts it is uncertain how the link changes flanks.
constexpr ParameterKind greased_gap{"gap", "rad", 0, 0.2};

/// Displacement (rad, T) of a link relative to its motor. A flank of the gear's teeth carries the link. When
/// the load changes sign, the link falls through the gap, and the other flank catches it without rebound.
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

/// The hardness of the tooth impact, and the time in which the link changes flanks, are unknown. Below this
/// frequency (Hz) they hardly matter.
constexpr double sure_hz = 7;

Eigen::VectorXd sure_part(const DiagnosisSignals& signals, std::size_t joint, const Eigen::VectorXd& travel) {
    const double smoothing_hz = signals.measured.smoothing_hz[static_cast<Eigen::Index>(joint)];
    return smooth_change(signals, joint, travel, std::min(1.0, sure_hz / smoothing_hz));
}

/// Change of the outputs (T x m) that a backlash of `gap` at a joint causes, divided by the gap.
Eigen::MatrixXd backlash_course(const DiagnosisSignals& signals, std::size_t joint, double gap) {
    const Eigen::VectorXd travel = travel_in_gap(signals, static_cast<Eigen::Index>(joint), gap) / gap;
    return signals.of_position(joint, sure_part(signals, joint, travel));
}

std::string family_of(std::size_t joint) { return "backlash at " + place_text(PlaceKind::joint, joint); }

/// How a link changes flanks without an impact. Loads are relative to the rms of the rigid body's torque.
struct Greased {
    double friction = 0; ///< dry friction at the link
    /// Of a soft gear: load that holds the link at three quarters of its travel. 0: of grease.
    double wide = 0;
    /// Lag of the soft gear, or time in which a load of 1 moves the link through the grease.
    double time_s = 0;
};

/// Displacement (T) of a link that follows its load from flank to flank, per gap.
Eigen::VectorXd travel_in_grease(const DiagnosisSignals& signals, Eigen::Index joint, const Greased& gear) {
    constexpr double load_hz = 2.5; // faster, the measured acceleration shows the changes of flank themselves
    const Eigen::VectorXd torque = signals.joint_torque.col(joint);
    const double rms = std::max(1e-9, torque.norm() / std::sqrt(static_cast<double>(torque.size())));
    const Eigen::VectorXd load =
        signals.below(load_hz, torque / rms + gear.friction * signals.direction(joint));
    const double steps = 1 / (signals.measured.rate_hz * gear.time_s);
    const bool soft = gear.wide > 0;
    Eigen::VectorXd travel(signals.rows());
    for (const Stretch& stretch : signals.measured.stretches) {
        double position = std::copysign(0.5, -load[stretch.first]);
        for (Eigen::Index row = stretch.first; row < stretch.first + stretch.count; ++row) {
            position -= soft ? (0.5 * std::tanh(load[row] / gear.wide) + position) * -std::expm1(-steps)
                             : steps * load[row];
            travel[row] = position = std::clamp(position, -0.5, 0.5);
        }
    }
    return travel;
}

std::vector<Greased> all_greased() {
    std::vector<Greased> gears;
    for (const double friction : {0.0, 0.4, 0.8}) {
        gears.push_back({friction, 0.1, 0.03});
        gears.push_back({friction, 0, 0.03});
        gears.push_back({friction, 0, 0.1});
    }
    return gears;
}

/// Returns a gear and those a little different from it.
std::vector<Greased> near(const Greased& gear) {
    const auto& [friction, wide, time_s] = gear;
    std::vector<Greased> gears{gear,
                               {std::max(0.0, friction - 0.15), wide, time_s},
                               {friction + 0.15, wide, time_s},
                               {friction, wide, 1.3 * time_s},
                               {friction, wide, time_s / 1.3}};
    if (wide > 0) {
        gears.push_back({friction, 1.5 * wide, time_s});
        gears.push_back({friction, wide / 1.5, time_s});
    }
    return gears;
}

/// Change of the outputs (T x m) per gap.
Eigen::MatrixXd greased_course(const DiagnosisSignals& signals, std::size_t joint, const Greased& gear) {
    const Eigen::VectorXd travel = travel_in_grease(signals, static_cast<Eigen::Index>(joint), gear);
    return signals.of_position(joint, sure_part(signals, joint, travel));
}

/// Backlash without impacts, as with grease in the gap or friction at the link. The gap is the coefficient.
Candidate greased_candidate(const DiagnosisSignals& signals, std::size_t joint,
                            const std::vector<Greased>& gears) {
    constexpr double widest = 0.15; // rad
    Candidate result;
    result.where = place_text(PlaceKind::joint, joint);
    result.family = family_of(joint);
    result.detail = "without impacts";
    for (const Greased& gear : gears) {
        result.shapes.push_back({{result.columns.size()}, positive_up_to(widest)});
        result.columns.push_back(on_outputs(greased_course(signals, joint, gear)));
    }
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape&) {
        return std::vector{greased_gap.at(coefficients[0])};
    };
    result.relinearized_at = [&signals, joint, gears](const EffectShape& shape, const Eigen::VectorXd&) {
        return greased_candidate(signals, joint, near(gears[shape.columns.front()]));
    };
    return result;
}

constexpr double narrowest_gap = 5e-4; // rad
constexpr double widest_gap = 0.1;
constexpr double gap_ratio = 1.5; // from one gap to the next

/// Searches, for each joint, for the course that correlates best with the residual.
class BacklashScan : public EffectScan {
  public:
    BacklashScan(const DiagnosisSignals& signals, const SpectralRows& rows);
    std::vector<Candidate> candidates(const FittedResidual& residual) const override;

  private:
    struct Course {
        double gap = 0;             ///< of a course with impacts
        Greased gear;               ///< of a course without
        Eigen::MatrixXd series;     ///< T x m
        Eigen::MatrixXd power = {}; ///< bins x m: sums of squares
    };
    struct Best {
        const Course* course = nullptr; ///< null: none correlates
        double explained = 0;           ///< weighted sum of squares that its column alone explains
    };
    struct Joint {
        std::vector<Course> impacts, greased;
    };
    static Best best(const FittedResidual& residual, const std::vector<Course>& courses);

    std::vector<Joint> joints_;
};

BacklashScan::BacklashScan(const DiagnosisSignals& signals, const SpectralRows& rows)
    : joints_(signals.joints()) {
    const auto with_power = [&](Course course) {
        course.power.resize(rows.bins(), signals.outputs());
        for (Eigen::Index output = 0; output < signals.outputs(); ++output) {
            course.power.col(output) =
                rows.analyse(course.series.col(output), output).rowwise().squaredNorm();
        }
        return course;
    };
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
        for (double gap = narrowest_gap; gap < widest_gap; gap *= gap_ratio) {
            joints_[joint].impacts.push_back(with_power({gap, {}, backlash_course(signals, joint, gap)}));
        }
        for (const Greased& gear : all_greased()) {
            joints_[joint].greased.push_back(with_power({0, gear, greased_course(signals, joint, gear)}));
        }
    }
}

BacklashScan::Best BacklashScan::best(const FittedResidual& residual, const std::vector<Course>& courses) {
    Best best;
    for (const Course& course : courses) {
        const double product = residual.weighted.cwiseProduct(course.series).sum();
        const double energy = course.power.cwiseQuotient(residual.regression.noise()).sum();
        const double explained = product > 0 && energy > 0 ? product * product / energy : 0;
        if (explained > best.explained) {
            best = {&course, explained};
        }
    }
    return best;
}

/// A greased gear fits many courses. It is preferred only where it is clearly better than an impact.
std::vector<Candidate> BacklashScan::candidates(const FittedResidual& residual) const {
    constexpr double clearly = 20; // of the explained sum of squares
    std::vector<Candidate> result;
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) {
        const Best impact = best(residual, joints_[joint].impacts);
        const Best greased = best(residual, joints_[joint].greased);
        if (greased.explained > impact.explained + clearly) {
            result.push_back(greased_candidate(residual.signals, joint, near(greased.course->gear)));
        } else if (impact.course != nullptr) {
            const double found = impact.course->gap;
            result.push_back(
                backlash_candidate(residual.signals, joint, {found, found / 1.25, found * 1.25}));
        } else {
            continue;
        }
        result.back().prior_trials = static_cast<double>(joints_[joint].impacts.size()) / 3;
    }
    return result;
}

} // namespace

Candidate backlash_candidate(const DiagnosisSignals& signals, std::size_t joint,
                             const std::vector<double>& gaps) {
    Candidate result;
    result.where = place_text(PlaceKind::joint, joint);
    result.family = family_of(joint);
    for (const double gap : gaps) {
        const auto allowed = [gap](const Eigen::VectorXd& coefficients) {
            constexpr double least = 0.25; // only the link's share of the joint's inertia is caught
            constexpr double most = 1.8;
            return coefficients[0] > least * gap && coefficients[0] < most * gap;
        };
        result.shapes.push_back({{result.columns.size()}, allowed, gap});
        result.columns.push_back(on_outputs(backlash_course(signals, joint, gap)));
    }
    // The gap follows from the course, that is, from the duration of the fall. The coefficient only describes
    // how hard the link is caught. Without an impact, as in grease, it would be the gap.
    result.parameters = [](const Eigen::VectorXd& coefficients, const EffectShape& shape) {
        EffectParameter gap = backlash_gap.at(shape.value);
        const double softer = std::max(0.0, 1 - coefficients[0] / shape.value);
        gap.systematic_relative_std = std::hypot(gap.systematic_relative_std, softer / 2);
        return std::vector{gap};
    };
    result.relinearized_at = [&signals, joint](const EffectShape& shape, const Eigen::VectorXd&) {
        const double found = shape.value;
        return backlash_candidate(signals, joint,
                                  {found, found / 1.12, found / 1.04, found * 1.04, found * 1.12});
    };
    return result;
}

Effect effects::backlash() {
    return {
        .name = "backlash",
        .where = "jointK",
        .parameters = {backlash_gap},
        .evidence = "looks like a position that jumps when the joint's load changes sign",
        .experiment = "load this joint by hand to both sides with its motor held, and measure the play at "
                      "the link",
        .in_extended_model = "left out",
        .scan = [](const DiagnosisSignals& signals, const SpectralRows& rows) -> std::unique_ptr<EffectScan> {
            return std::make_unique<BacklashScan>(signals, rows);
        },
        .plotted_over = over_load};
}

} // namespace dfdyn::tools
