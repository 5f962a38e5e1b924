// SPDX-License-Identifier: Apache-2.0
#include "tools/training/likelihood/random_features.hpp"

#include "tools/base/numerics/linear_algebra.hpp"
#include "tools/base/numerics/random_source.hpp"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

namespace dfdyn::tools {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr std::uint32_t frequency_stream = 0xffffffff; // the optimiser's starts use the streams from 0 on

/// Uniformly distributed orthogonal matrix: Q of a normal matrix, with the signs that make R's diagonal
/// positive.
Eigen::MatrixXd random_rotation(Eigen::Index size, NormalSource& random) {
    const auto [q, r] = orthogonal_factors(random.matrix(size, size));
    const Eigen::VectorXd signs = r.diagonal().array().sign();
    return q * signs.asDiagonal();
}

RowMajor orthogonal_frequencies(Eigen::Index count, Eigen::Index inputs, NormalSource& random) {
    RowMajor omega(count, inputs);
    for (Eigen::Index first = 0; first < count; first += inputs) {
        const Eigen::Index rows = std::min(inputs, count - first);
        const Eigen::MatrixXd directions = random_rotation(inputs, random);
        const Eigen::VectorXd lengths = random.matrix(inputs, inputs).rowwise().norm();
        omega.middleRows(first, rows) = lengths.head(rows).asDiagonal() * directions.topRows(rows);
    }
    return omega;
}

} // namespace

FeatureModel draw_features(int count, int inputs, bool orthogonal, double length_scale, std::uint64_t seed) {
    NormalSource random(seed, frequency_stream);
    const RowMajor omega =
        orthogonal ? orthogonal_frequencies(count, inputs, random) : RowMajor(random.matrix(count, inputs));
    FeatureModel model;
    model.orthogonal = orthogonal;
    model.count = count;
    model.seed = seed;
    model.omega.assign(omega.data(), omega.data() + omega.size());
    model.length_scale = length_scale;
    return model;
}

Eigen::MatrixXd random_features(const FeatureModel& model, const Eigen::MatrixXd& inputs) {
    const Eigen::Map<const RowMajor> omega(model.omega.data(), model.count, inputs.cols());
    const Eigen::MatrixXd phase = inputs * omega.transpose() / model.length_scale;
    Eigen::MatrixXd features(inputs.rows(), 2 * model.count);
    features.leftCols(model.count) = phase.array().cos();
    features.rightCols(model.count) = phase.array().sin();
    return features / std::sqrt(static_cast<double>(model.count));
}

} // namespace dfdyn::tools
