// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/spectral_rows.hpp"

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {

namespace {

LappedTransform transform_at(double rate_hz) {
    const auto hop = std::llround(SpectralRows::hop_s * rate_hz);
    const double highest = std::min(SpectralRows::highest_hz, 0.4 * rate_hz);
    return {hop, std::llround(2 * SpectralRows::hop_s * highest)};
}

/// Number of the uppermost bins that are zero in all frames.
Eigen::Index zero_bins(const Eigen::MatrixXd& coefficients) {
    Eigen::Index zero = 0;
    while (zero < coefficients.rows() && coefficients.row(coefficients.rows() - 1 - zero).isZero(0)) {
        ++zero;
    }
    return zero;
}

constexpr Eigen::Index slow_bins = 4;

/// Number of neighbouring frames that carry the information of one independent frame, for noise that is
/// correlated over several frames.
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
    : transform_(transform_at(measured.rate_hz)), weight_(measured.weight) {
    const Eigen::Index hop = transform_.hop();
    const Eigen::Index outputs = measured.outputs.cols();
    for (const Stretch& stretch : measured.stretches) {
        stretches_.push_back({stretch, frames_, (stretch.count + hop - 1) / hop + 1});
        frames_ += stretches_.back().frames;
    }
    if (weight_.size() == 0) {
        weight_.setOnes(measured.time_s.size(), outputs);
    }
    filled_.resize(outputs, frames_);
    bins_above_bandwidth_.setZero(outputs);
    for (Eigen::Index output = 0; output < outputs; ++output) {
        filled_.row(output) = filled_by(weight_.col(output));
        for (Eigen::Index bin = 0; bin < bins() && measured.response_bandwidth_hz.size() > 0; ++bin) {
            bins_above_bandwidth_[output] +=
                frequency_hz(bin) > measured.response_bandwidth_hz[output] ? 1 : 0;
        }
    }
}

Eigen::Index SpectralRows::frames_within(double share) const {
    auto left = std::llround(share * static_cast<double>(weight_.rows()));
    for (const PaddedStretch& stretch : stretches_) {
        if (left < stretch.rows.count) {
            return std::max<Eigen::Index>(1, stretch.first_frame + left / transform_.hop());
        }
        left -= stretch.rows.count;
    }
    return frames_;
}

Eigen::VectorXd SpectralRows::padded(const Eigen::VectorXd& series, const PaddedStretch& stretch) const {
    const Eigen::Index hop = transform_.hop();
    Eigen::VectorXd result = Eigen::VectorXd::Zero((stretch.frames + 1) * hop);
    result.segment(hop, stretch.rows.count) = series.segment(stretch.rows.first, stretch.rows.count);
    return result;
}

Eigen::MatrixXd SpectralRows::analyse(const Eigen::VectorXd& series) const {
    Eigen::MatrixXd result(bins(), frames_);
    for (const PaddedStretch& stretch : stretches_) {
        result.middleCols(stretch.first_frame, stretch.frames) = transform_.analyse(padded(series, stretch));
    }
    return result;
}

Eigen::MatrixXd SpectralRows::analyse(const Eigen::VectorXd& series, Eigen::Index output) const {
    Eigen::MatrixXd result = analyse(series.cwiseProduct(weight_.col(output)));
    result.bottomRows(bins_above_bandwidth_[output]).setZero();
    return result;
}

Eigen::VectorXd SpectralRows::synthesise(const Eigen::MatrixXd& coefficients, Eigen::Index output) const {
    const Eigen::Index hop = transform_.hop();
    Eigen::MatrixXd in_band = coefficients;
    in_band.bottomRows(bins_above_bandwidth_[output]).setZero();
    Eigen::VectorXd series(weight_.rows());
    for (const PaddedStretch& stretch : stretches_) {
        series.segment(stretch.rows.first, stretch.rows.count) =
            transform_
                .synthesise(in_band.middleCols(stretch.first_frame, stretch.frames),
                            (stretch.frames + 1) * hop)
                .segment(hop, stretch.rows.count);
    }
    return series.cwiseProduct(weight_.col(output));
}

Eigen::RowVectorXd SpectralRows::filled_by(const Eigen::VectorXd& weight) const {
    const Eigen::Index hop = transform_.hop();
    Eigen::RowVectorXd result(frames_);
    for (const PaddedStretch& stretch : stretches_) {
        const Eigen::VectorXd squares = padded(weight, stretch).cwiseAbs2();
        for (Eigen::Index frame = 0; frame < stretch.frames; ++frame) {
            result[stretch.first_frame + frame] =
                squares.segment(frame * hop, 2 * hop).dot(transform_.window_squares());
        }
    }
    return result;
}

Eigen::VectorXd noise_spectrum(const Eigen::MatrixXd& coefficients, const Eigen::RowVectorXd& filled,
                               const Eigen::VectorXd& spent) {
    // of the frames: after an exact fit the residual carries no information on the noise
    constexpr double least_left = 0.1;
    const Eigen::Index bins = coefficients.rows() - zero_bins(coefficients);
    const double frames = std::max(filled.sum(), 1e-9);
    const Eigen::VectorXd left = (frames - spent.head(bins).array()).max(least_left * frames);
    const Eigen::VectorXd power = coefficients.topRows(bins).rowwise().squaredNorm().cwiseQuotient(left);
    Eigen::VectorXd spectrum(coefficients.rows());
    for (Eigen::Index bin = 0; bin < bins; ++bin) {
        const Eigen::Index reach = std::min<Eigen::Index>({1 + bin / 6, bin, bins - 1 - bin});
        spectrum[bin] = power.segment(bin - reach, 2 * reach + 1).mean();
    }
    for (Eigen::Index bin = 0; bin < std::min<Eigen::Index>(slow_bins, bins); ++bin) {
        spectrum[bin] *= persistence(coefficients.row(bin));
    }
    spectrum.tail(coefficients.rows() - bins).setConstant(bins > 0 ? spectrum.head(bins).mean() : 0);
    return spectrum.cwiseMax(1e-9 * spectrum.maxCoeff() + 1e-300);
}

Eigen::MatrixXd local_noise_scale(const Eigen::MatrixXd& coefficients, const Eigen::RowVectorXd& filled,
                                  const Eigen::VectorXd& spectrum) {
    constexpr double prior_freedom = 8; // degrees of freedom of the prior scale 1
    const Eigen::MatrixXd power = spectrum.cwiseInverse().asDiagonal() * coefficients.cwiseAbs2();
    Eigen::MatrixXd noise_scale(power.rows(), power.cols());
    const Eigen::Index holding = coefficients.rows() - zero_bins(coefficients);
    Eigen::Index first = 0;
    for (const Eigen::Index last : {Eigen::Index{8}, Eigen::Index{32}, power.rows()}) {
        const Eigen::Index count = std::min(last, power.rows()) - first;
        if (count > 0) {
            const auto held = static_cast<double>(std::clamp<Eigen::Index>(holding - first, 0, count));
            const Eigen::RowVectorXd total = power.middleRows(first, count).colwise().sum() +
                                             (static_cast<double>(count) - held * filled.array()).matrix();
            noise_scale.middleRows(first, count).rowwise() =
                ((total.array() + prior_freedom) / (static_cast<double>(count) + prior_freedom)).matrix();
            first += count;
        }
    }
    return noise_scale;
}

} // namespace dfdyn::tools
