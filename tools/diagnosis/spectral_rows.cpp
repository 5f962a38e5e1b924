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

/// Of a stretch with a hop of nothing before it and at least one behind.
Eigen::Index padded_frames(const Stretch& stretch, Eigen::Index hop) {
    return (stretch.count + hop - 1) / hop + 1;
}

/// How many of the upper ones hold nothing.
Eigen::Index zero_bins(const Eigen::MatrixXd& coefficients) {
    Eigen::Index zero = 0;
    while (zero < coefficients.rows() && coefficients.row(coefficients.rows() - 1 - zero).isZero(0)) {
        ++zero;
    }
    return zero;
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
      answered_hz_(measured.answered_hz), weight_(measured.weight), rows_(measured.time_s.size()) {
    for (const Stretch& stretch : stretches_) {
        frames_ += padded_frames(stretch, transform_.hop());
    }
}

Eigen::Index SpectralRows::frames_within(double share) const {
    auto left = std::llround(share * static_cast<double>(rows_));
    Eigen::Index within = 0;
    for (const Stretch& stretch : stretches_) {
        if (left < stretch.count) {
            return std::max<Eigen::Index>(1, within + left / transform_.hop());
        }
        left -= stretch.count;
        within += padded_frames(stretch, transform_.hop());
    }
    return within;
}

Eigen::VectorXd SpectralRows::weight(Eigen::Index output) const {
    return weight_.size() == 0 ? Eigen::VectorXd::Ones(rows_) : Eigen::VectorXd(weight_.col(output));
}

Eigen::MatrixXd SpectralRows::analyse(const Eigen::VectorXd& series) const {
    const Eigen::Index hop = transform_.hop();
    Eigen::MatrixXd result(bins(), frames_);
    Eigen::Index first = 0;
    for (const Stretch& stretch : stretches_) {
        const Eigen::Index count = padded_frames(stretch, hop);
        Eigen::VectorXd padded = Eigen::VectorXd::Zero((count + 1) * hop);
        padded.segment(hop, stretch.count) = series.segment(stretch.first, stretch.count);
        result.middleCols(first, count) = transform_.analyse(padded);
        first += count;
    }
    return result;
}

Eigen::Index SpectralRows::answered_bins(Eigen::Index output) const {
    Eigen::Index answered = 0;
    while (answered < bins() &&
           (answered_hz_.size() == 0 || frequency_hz(answered) <= answered_hz_[output])) {
        ++answered;
    }
    return answered;
}

Eigen::MatrixXd SpectralRows::analyse(const Eigen::VectorXd& series, Eigen::Index output) const {
    Eigen::MatrixXd result = analyse(series.cwiseProduct(weight(output)));
    result.bottomRows(bins() - answered_bins(output)).setZero();
    return result;
}

Eigen::VectorXd SpectralRows::synthesise(const Eigen::MatrixXd& coefficients, Eigen::Index output) const {
    const Eigen::Index hop = transform_.hop();
    Eigen::MatrixXd answered = coefficients;
    answered.bottomRows(bins() - answered_bins(output)).setZero();
    Eigen::VectorXd series(rows_);
    Eigen::Index first = 0;
    for (const Stretch& stretch : stretches_) {
        const Eigen::Index count = padded_frames(stretch, hop);
        series.segment(stretch.first, stretch.count) =
            transform_.synthesise(answered.middleCols(first, count), (count + 1) * hop)
                .segment(hop, stretch.count);
        first += count;
    }
    return series.cwiseProduct(weight(output));
}

Eigen::RowVectorXd SpectralRows::filled(Eigen::Index output) const {
    const Eigen::VectorXd squares = weight(output).cwiseAbs2();
    const Eigen::Index hop = transform_.hop();
    Eigen::RowVectorXd result(frames_);
    Eigen::Index first = 0;
    for (const Stretch& stretch : stretches_) {
        const Eigen::Index count = padded_frames(stretch, hop);
        Eigen::VectorXd padded = Eigen::VectorXd::Zero((count + 1) * hop);
        padded.segment(hop, stretch.count) = squares.segment(stretch.first, stretch.count);
        for (Eigen::Index frame = 0; frame < count; ++frame) {
            result[first + frame] = padded.segment(frame * hop, 2 * hop).dot(transform_.window_squares());
        }
        first += count;
    }
    return result;
}

Eigen::VectorXd noise_spectrum(const Eigen::MatrixXd& coefficients, const Eigen::RowVectorXd& filled,
                               const Eigen::VectorXd& spent) {
    constexpr double least_left = 0.1; // of the frames: an exact fit tells nothing of the noise
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

Eigen::MatrixXd noise_unrest(const Eigen::MatrixXd& coefficients, const Eigen::RowVectorXd& filled,
                             const Eigen::VectorXd& spectrum) {
    constexpr double usual = 8; // degrees of freedom: what counts as usual unless the frame says otherwise
    const Eigen::MatrixXd power = spectrum.cwiseInverse().asDiagonal() * coefficients.cwiseAbs2();
    Eigen::MatrixXd unrest(power.rows(), power.cols());
    const Eigen::Index holding = coefficients.rows() - zero_bins(coefficients);
    Eigen::Index first = 0;
    for (const Eigen::Index last : {Eigen::Index{8}, Eigen::Index{32}, power.rows()}) {
        const Eigen::Index count = std::min(last, power.rows()) - first;
        if (count > 0) {
            const auto held = static_cast<double>(std::clamp<Eigen::Index>(holding - first, 0, count));
            const Eigen::RowVectorXd total = power.middleRows(first, count).colwise().sum() +
                                             (static_cast<double>(count) - held * filled.array()).matrix();
            unrest.middleRows(first, count).rowwise() =
                ((total.array() + usual) / (static_cast<double>(count) + usual)).matrix();
            first += count;
        }
    }
    return unrest;
}

} // namespace dfdyn::tools
