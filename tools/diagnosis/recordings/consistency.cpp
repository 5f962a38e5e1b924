// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/recordings/consistency.hpp"

#include "tools/base/text/number.hpp"
#include "tools/diagnosis/effects/effect_catalogue.hpp"
#include "tools/diagnosis/recordings/recording_information.hpp"
#include "tools/diagnosis/verdict/findings.hpp"
#include "tools/diagnosis/verdict/textbook.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace dfdyn::tools {

namespace {

using Eigen::Index;
using Eigen::VectorXd;

struct Size {
    double factor = 1, variance = 0;
};

/// Returns the size of a finding in each recording with at least 1 % of its squares.
std::vector<Size> sizes_of(const DiagnosisWork& work, const Finding& finding,
                           const std::vector<double>& ends_s) {
    constexpr double least_share = 0.01; // of the contribution's squares in all recordings
    const MeasuredMotion& measured = work.signals->measured;
    const VectorXd weight = row_weight(*work.signals, finding.output);
    const double all = weight.dot(finding.share.cwiseAbs2());
    std::vector<Size> sizes;
    Index first = 0;
    for (const double end_s : ends_s) {
        const Index end = (measured.time_s.array() <= end_s + 1e-6).count();
        const Index count = end - first;
        const VectorXd own = weight.segment(first, count);
        const VectorXd share = finding.share.segment(first, count);
        const VectorXd rest = finding.rest.segment(first, count);
        first = end;
        const double square = count > 0 ? own.dot(share.cwiseAbs2()) : 0;
        if (square > least_share * all && rest.squaredNorm() > 0) {
            const double noise = weighted_mean_square(rest, own);
            sizes.push_back({1 + own.cwiseProduct(share).dot(rest) / square,
                             noise * correlated_rows(rest, own, measured.rate_hz) / square});
        }
    }
    return sizes;
}

/// Returns whether the mean size, with its spread between recordings, is less than two deviations above zero.
bool contradict(const std::vector<Size>& sizes) {
    constexpr double significant_deviations = 2;
    double weights = 0, squares = 0, mean = 0;
    for (const Size& size : sizes) {
        weights += 1 / size.variance;
        squares += 1 / (size.variance * size.variance);
        mean += size.factor / size.variance;
    }
    mean /= weights;
    double scatter = 0;
    for (const Size& size : sizes) {
        scatter += std::pow(size.factor - mean, 2) / size.variance;
    }
    const double freedom = static_cast<double>(sizes.size()) - 1;
    const double between = std::max(0.0, (scatter - freedom) / (weights - squares / weights));
    double pooled = 0, precision = 0;
    for (const Size& size : sizes) {
        pooled += size.factor / (size.variance + between);
        precision += 1 / (size.variance + between);
    }
    return pooled < significant_deviations * std::sqrt(precision); // mean = pooled / precision
}

std::string factors_text(const std::vector<Size>& sizes) {
    std::string text;
    for (const Size& size : sizes) {
        text.append(text.empty() ? "" : ", ").append(formatted("%.2f", size.factor));
    }
    return text;
}

} // namespace

void doubt_contradicted_findings(DiagnosisWork& work, const std::vector<double>& ends_s) {
    for (Finding& finding : work.diagnosis.findings) {
        if (!finding.by_recording.empty() || !finding.only_in.empty() ||
            has_trait(finding.effect, &Effect::interval)) {
            continue;
        }
        const std::vector<Size> sizes = sizes_of(work, finding, ends_s);
        if (sizes.size() > 1 && contradict(sizes)) {
            finding.confidence = std::min(finding.confidence, unlikely);
            finding.evidence +=
                " (the recordings contradict it: relative to the size found, its size in each is " +
                factors_text(sizes) + ")";
        }
    }
}

} // namespace dfdyn::tools
