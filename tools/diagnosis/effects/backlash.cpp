// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/candidates/candidate_parts.hpp"
#include "tools/diagnosis/candidates/candidates.hpp"
#include "tools/diagnosis/candidates/effect_regression.hpp"
#include "tools/diagnosis/candidates/true_position.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/output/plot_abscissa.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

// Relative model error: the link's share of the joint's motion in the gap is uncertain. For simulated gears
// the estimated gap is up to 13 % too wide.
constexpr ParameterKind backlash_gap{"gap", "rad", 0, 0.08};

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

constexpr double narrowest_gap = 5e-4; // rad
constexpr double widest_gap = 0.1;
constexpr double gap_ratio = 1.5; // from one gap to the next

/// Searches, for each joint, for the gap whose torque course correlates best with the residual.
class BacklashScan : public EffectScan {
  public:
    BacklashScan(const DiagnosisSignals& signals, const SpectralRows& rows);
    std::vector<Candidate> candidates(const FittedResidual& residual) const override;

  private:
    struct Course {
        double gap = 0;
        Eigen::MatrixXd series; ///< T x m
        Eigen::MatrixXd power;  ///< bins x m: sums of squares
    };
    std::vector<std::vector<Course>> courses_; ///< per joint
};

BacklashScan::BacklashScan(const DiagnosisSignals& signals, const SpectralRows& rows)
    : courses_(signals.joints()) {
    for (std::size_t joint = 0; joint < signals.joints(); ++joint) {
        for (double gap = narrowest_gap; gap < widest_gap; gap *= gap_ratio) {
            Course course{gap, play_course(signals, joint, gap),
                          Eigen::MatrixXd(rows.bins(), signals.outputs())};
            for (Eigen::Index output = 0; output < signals.outputs(); ++output) {
                course.power.col(output) =
                    rows.analyse(course.series.col(output), output).rowwise().squaredNorm();
            }
            courses_[joint].push_back(std::move(course));
        }
    }
}

std::vector<Candidate> BacklashScan::candidates(const FittedResidual& residual) const {
    std::vector<Candidate> result;
    for (std::size_t joint = 0; joint < courses_.size(); ++joint) {
        double best = 0;
        double found = 0;
        for (const Course& course : courses_[joint]) {
            const double product = residual.weighted.cwiseProduct(course.series).sum();
            const double energy = course.power.cwiseQuotient(residual.regression.noise()).sum();
            const double gain = product > 0 && energy > 0 ? product * product / energy : 0;
            if (gain > best) {
                best = gain;
                found = course.gap;
            }
        }
        if (found > 0) {
            result.push_back(
                backlash_candidate(residual.signals, joint, {found, found / 1.25, found * 1.25}));
            result.back().tried = static_cast<double>(courses_[joint].size()) / 3;
        }
    }
    return result;
}

} // namespace

Eigen::MatrixXd play_course(const DiagnosisSignals& signals, std::size_t joint, double gap) {
    constexpr double sure_hz = 7; // the hardness of the tooth impact is unknown
    const auto index = static_cast<Eigen::Index>(joint);
    const Eigen::VectorXd travel = travel_in_gap(signals, index, gap) / gap;
    return signals.of_position(
        joint,
        smooth_change(signals, joint, travel, std::min(1.0, sure_hz / signals.measured.smoothing_hz[index])));
}

Candidate backlash_candidate(const DiagnosisSignals& signals, std::size_t joint,
                             const std::vector<double>& gaps) {
    Candidate result;
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
    // The gap follows from the course, that is, from the duration of the fall. The coefficient only describes
    // how hard the link is caught.
    result.parameters = [](const Eigen::VectorXd&, const EffectShape& shape) {
        return std::vector{backlash_gap.at(shape.value)};
    };
    result.about = [&signals, joint](const EffectShape& shape, const Eigen::VectorXd&) {
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
