// SPDX-License-Identifier: Apache-2.0
#include "tools/training/data/stored_motion.hpp"

#include "tools/base/numerics/to_vector.hpp"
#include "tools/training/data/input_map.hpp"

namespace dfdyn::tools {

using Eigen::MatrixXd;

MotionSamples stored_motion(const InputModel& motion, const TrainingData& data, const RowList& rows) {
    const MatrixXd xi = stored_inputs(motion, data, rows);
    const auto part = [&xi](Eigen::Index first) {
        return MatrixXd(xi(Eigen::all, Eigen::seq(first, Eigen::last, 3)));
    };
    return {part(0), part(1), part(2)};
}

std::vector<double> motion_limits(const InputModel& motion, const TrainingData& data) {
    constexpr double margin = 10;
    constexpr double least = 1e-3; // for a joint that did not move
    const MatrixXd xi = stored_inputs(motion, data, usable_rows(data.gap_before, motion.lags));
    const Eigen::VectorXd limits = (margin * xi.cwiseAbs().colwise().maxCoeff().transpose()).cwiseMax(least);
    return to_vector(limits);
}

} // namespace dfdyn::tools
