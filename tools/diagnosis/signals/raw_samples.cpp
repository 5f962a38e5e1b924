// SPDX-License-Identifier: Apache-2.0
#include "tools/diagnosis/signals/raw_samples.hpp"

#include "tools/base/recording/columns_matrix.hpp"
#include "tools/diagnosis/signals/cubic_weights.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace dfdyn::tools {

Eigen::MatrixXd RawSamples::at(const Eigen::MatrixXd& series) const {
    Eigen::MatrixXd result(outputs.rows(), series.cols());
    for (Eigen::Index sample = 0; sample < result.rows(); ++sample) {
        result.row(sample) =
            weights.row(sample) * series.middleRows<4>(rows[static_cast<std::size_t>(sample)]);
    }
    return result;
}

Eigen::Index RawSamples::nearest(Eigen::Index sample) const {
    Eigen::Index offset = 0;
    weights.row(sample).maxCoeff(&offset);
    return rows[static_cast<std::size_t>(sample)] + offset;
}

Eigen::Index RawSamples::before(Eigen::Index row) const {
    Eigen::Index sample = 0;
    while (sample < outputs.rows() && nearest(sample) < row) {
        ++sample;
    }
    return sample;
}

RawSamples raw_samples(const Recording& recording, const MeasuredMotion& measured) {
    std::vector<Eigen::Index> used;
    std::vector<Eigen::RowVector4d> weights;
    RawSamples samples;
    std::size_t row = 0;
    for (const Stretch& stretch : measured.stretches) {
        const double start_s = measured.time_s[stretch.first];
        const double end_s = measured.time_s[stretch.first + stretch.count - 1];
        for (; row < recording.row_count() && recording.time_s[row] <= end_s + 1e-9; ++row) {
            const double at = (recording.time_s[row] - start_s) * measured.rate_hz;
            if (at < -1e-6) {
                continue;
            }
            const Eigen::Index first =
                std::clamp<Eigen::Index>(static_cast<Eigen::Index>(std::floor(at)) - 1, 0, stretch.count - 4);
            used.push_back(static_cast<Eigen::Index>(row));
            samples.rows.push_back(stretch.first + first);
            weights.push_back(cubic_weights({0, 1, 2, 3}, at - static_cast<double>(first)));
        }
    }
    samples.outputs = columns_matrix(recording.output)(used, Eigen::all);
    samples.weights.resize(std::ssize(weights), 4);
    for (std::size_t sample = 0; sample < weights.size(); ++sample) {
        samples.weights.row(static_cast<Eigen::Index>(sample)) = weights[sample];
    }
    return samples;
}

RawSamples own_samples(const MeasuredMotion& measured, Eigen::MatrixXd outputs) {
    RawSamples samples;
    samples.weights.setZero(outputs.rows(), 4);
    for (const Stretch& stretch : measured.stretches) {
        for (Eigen::Index row = 0; row < stretch.count; ++row) {
            const Eigen::Index first = std::clamp<Eigen::Index>(row - 1, 0, stretch.count - 4);
            samples.weights(std::ssize(samples.rows), row - first) = 1;
            samples.rows.push_back(stretch.first + first);
        }
    }
    samples.outputs = std::move(outputs);
    return samples;
}

} // namespace dfdyn::tools
