// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/spectral_rows.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

LappedTransform transform_at(double rate_hz) {
    const auto hop = std::llround(SpectralRows::hop_s * rate_hz);
    const double highest = std::min(SpectralRows::highest_hz, 0.4 * rate_hz);
    return {hop, std::llround(2 * SpectralRows::hop_s * highest)};
}

constexpr Eigen::Index slow_bins = 4;

/// How many neighbouring frames tell as much as one independent one, of a noise that outlasts a frame.
double persistence(const Eigen::RowVectorXd& series) {
    const Eigen::Index last = series.size() - 1;
    if (last < 4) {
        return 1;
    }
    const double correlation =
        std::clamp(series.head(last).dot(series.tail(last)) / series.squaredNorm(), 0.0, 0.9);
    return (1 + correlation) / (1 - correlation);
}

} // namespace

SpectralRows::SpectralRows(const MeasuredMotion& measured)
    : transform_(transform_at(measured.rate_hz)), stretches_(measured.stretches),
      rows_(measured.time_s.size()) {
    for (const Stretch& stretch : stretches_) {
        const Eigen::Index count = transform_.frames(stretch.count);
        for (Eigen::Index frame = 0; frame < count; ++frame) {
            starts_s_.push_back(measured.time_s[stretch.first + frame * transform_.hop()]);
        }
        frames_ += count;
    }
}

Eigen::MatrixXd SpectralRows::analyse(const Eigen::VectorXd& series) const {
    Eigen::MatrixXd result(bins(), frames_);
    Eigen::Index first = 0;
    for (const Stretch& stretch : stretches_) {
        const Eigen::Index count = transform_.frames(stretch.count);
        result.middleCols(first, count) = transform_.analyse(series.segment(stretch.first, stretch.count));
        first += count;
    }
    return result;
}

Eigen::VectorXd SpectralRows::synthesise(const Eigen::MatrixXd& coefficients) const {
    Eigen::VectorXd series = Eigen::VectorXd::Zero(rows_);
    Eigen::Index first = 0;
    for (const Stretch& stretch : stretches_) {
        const Eigen::Index count = transform_.frames(stretch.count);
        series.segment(stretch.first, stretch.count) =
            transform_.synthesise(coefficients.middleCols(first, count), stretch.count);
        first += count;
    }
    return series;
}

Eigen::VectorXd noise_spectrum(const Eigen::MatrixXd& coefficients, const Eigen::VectorXd& spent) {
    constexpr double least_left = 0.1; // of the frames: an exact fit tells nothing of the noise
    const Eigen::Index bins = coefficients.rows();
    const auto frames = static_cast<double>(coefficients.cols());
    const Eigen::VectorXd left = (frames - spent.array()).max(least_left * frames);
    const Eigen::VectorXd power = coefficients.rowwise().squaredNorm().cwiseQuotient(left);
    Eigen::VectorXd spectrum(bins);
    for (Eigen::Index bin = 0; bin < bins; ++bin) {
        const Eigen::Index reach = std::min<Eigen::Index>({1 + bin / 6, bin, bins - 1 - bin});
        spectrum[bin] = power.segment(bin - reach, 2 * reach + 1).mean();
    }
    for (Eigen::Index bin = 0; bin < std::min<Eigen::Index>(slow_bins, bins); ++bin) {
        spectrum[bin] *= persistence(coefficients.row(bin));
    }
    return spectrum.cwiseMax(1e-9 * spectrum.maxCoeff() + 1e-300);
}

Eigen::MatrixXd noise_unrest(const Eigen::MatrixXd& coefficients, const Eigen::VectorXd& spectrum) {
    constexpr double degrees = 8; // of freedom: what counts as usual unless the frame says otherwise
    const Eigen::MatrixXd power = spectrum.cwiseInverse().asDiagonal() * coefficients.cwiseAbs2();
    Eigen::MatrixXd unrest(power.rows(), power.cols());
    Eigen::Index first = 0;
    for (const Eigen::Index last : {Eigen::Index{8}, Eigen::Index{32}, power.rows()}) {
        const Eigen::Index count = std::min(last, power.rows()) - first;
        if (count > 0) {
            const Eigen::RowVectorXd total = power.middleRows(first, count).colwise().sum();
            unrest.middleRows(first, count).rowwise() =
                ((total.array() + degrees) / (static_cast<double>(count) + degrees)).matrix();
            first += count;
        }
    }
    return unrest;
}

} // namespace dfdyn::tools
