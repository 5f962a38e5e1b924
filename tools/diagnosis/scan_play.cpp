// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/scans.hpp"

namespace dfdyn::tools {

namespace {

constexpr double narrowest = 5e-4; // rad
constexpr double widest = 0.1;
constexpr double gap_ratio = 1.5; // from one gap to the next

} // namespace

PlayScan::PlayScan(const DiagnosisSignals& signals, const SpectralRows& rows) : courses_(signals.joints()) {
    for (std::size_t joint = 0; joint < signals.joints(); ++joint) {
        for (double gap = narrowest; gap < widest; gap *= gap_ratio) {
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

std::vector<Candidate> PlayScan::candidates(const DiagnosisSignals& signals,
                                            const EffectRegression& regression,
                                            const Eigen::MatrixXd& weighed) const {
    std::vector<Candidate> result;
    for (std::size_t joint = 0; joint < courses_.size(); ++joint) {
        double best = 0;
        double found = 0;
        for (const Course& course : courses_[joint]) {
            const double product = weighed.cwiseProduct(course.series).sum();
            const double energy = course.power.cwiseQuotient(regression.noise()).sum();
            const double gain = product > 0 && energy > 0 ? product * product / energy : 0;
            if (gain > best) {
                best = gain;
                found = course.gap;
            }
        }
        if (found > 0) {
            result.push_back(backlash_candidate(signals, joint, {found, found / 1.25, found * 1.25}));
            result.back().tried = static_cast<double>(courses_[joint].size()) / 3;
        }
    }
    return result;
}

} // namespace dfdyn::tools
