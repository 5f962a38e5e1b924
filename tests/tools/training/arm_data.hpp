// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "tools/base/numerics/random_source.hpp"
#include "tools/training/data/row_selection.hpp"
#include "tools/training/data/training_data.hpp"

#include <cmath>
#include <string>

namespace dfdyn::tests {

/// A smooth motion of `joints` joints with exact derivatives, and outputs that depend on them, with noise.
inline tools::TrainingData arm_data(Eigen::Index samples, Eigen::Index joints, Eigen::Index outputs,
                                    tools::NormalSource& random) {
    tools::TrainingData data;
    data.sample_period_s = 0.01;
    data.positions = data.velocities = data.accelerations = Eigen::MatrixXd::Zero(samples, joints);
    for (Eigen::Index joint = 0; joint < joints; ++joint) {
        for (int wave = 1; wave <= 3; ++wave) {
            const double frequency = wave * (2 + 0.3 * std::tanh(random.next())); // rad/s
            const double phase = 6 * random.next();
            for (Eigen::Index t = 0; t < samples; ++t) {
                const double angle = frequency * data.sample_period_s * static_cast<double>(t) + phase;
                data.positions(t, joint) += std::sin(angle) / wave;
                data.velocities(t, joint) += frequency * std::cos(angle) / wave;
                data.accelerations(t, joint) -= frequency * frequency * std::sin(angle) / wave;
            }
        }
    }
    const Eigen::MatrixXd mix = random.matrix(3 * joints, outputs);
    Eigen::MatrixXd causes(samples, 3 * joints);
    causes << data.positions.array().sin().matrix(), (3 * data.velocities).array().tanh().matrix(),
        0.1 * data.accelerations;
    data.outputs = 3 + (causes * mix + 0.05 * random.matrix(samples, outputs)).array();
    data.gap_before.assign(static_cast<std::size_t>(samples), 0);
    data.gap_before[0] = 1;
    for (Eigen::Index k = 1; k <= outputs; ++k) {
        data.output_names.push_back("tau" + std::to_string(k));
    }
    return data;
}

/// Returns the rows first, first + stride, ... below `end`.
inline tools::RowList rows_between(Eigen::Index first, Eigen::Index end, Eigen::Index stride = 1) {
    tools::RowList rows;
    for (Eigen::Index row = first; row < end; row += stride) {
        rows.push_back(row);
    }
    return rows;
}

} // namespace dfdyn::tests
