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
    constexpr double least = 1e-3;          // for a joint that did not move
    constexpr std::size_t block_rows = 512; // bounds the memory of the windows
    const RowList rows = usable_rows(data.gap_before, motion.lags);
    Eigen::VectorXd largest;
    for (std::size_t first = 0; first < rows.size(); first += block_rows) {
        const auto begin = rows.begin() + static_cast<std::ptrdiff_t>(first);
        const auto count = static_cast<std::ptrdiff_t>(std::min(block_rows, rows.size() - first));
        const MatrixXd xi = stored_inputs(motion, data, {begin, begin + count});
        const Eigen::VectorXd here = xi.cwiseAbs().colwise().maxCoeff().transpose();
        largest = first == 0 ? here : Eigen::VectorXd(largest.cwiseMax(here));
    }
    return to_vector(Eigen::VectorXd((margin * largest).cwiseMax(least)));
}

} // namespace dfdyn::tools
