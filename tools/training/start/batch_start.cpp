// SPDX-License-Identifier: Apache-2.0
#include "tools/training/start/batch_start.hpp"

#include "tools/training/start/normal_equations.hpp"

namespace dfdyn::tools {

StartModel batch_start(const TrainedModel& model, const TrainingData& data, const RowList& rows,
                       const Eigen::MatrixXd& targets) {
    NormalEquations equations = normal_equations(model, data, rows, targets);
    equations.information.diagonal().array() +=
        prior_weight(model.forgetting_factor, targets.rows()) / model.outputs.prior_variance;
    const CovarianceFactor factor =
        information_factor(std::move(equations.information), model.outputs.prior_variance);
    const Eigen::MatrixXd weights = factor.solve(equations.right_hand_side);
    StartModel start;
    start.weights.assign(weights.data(), weights.data() + weights.size());
    store_inverse(factor, start.unit_upper, start.diagonal);
    return start;
}

StartModel batch_start(const TrainedModel& model, const TrainingData& data, const RowList& rows) {
    return batch_start(model, data, rows, scaled_outputs(model.outputs, data.outputs, rows));
}

} // namespace dfdyn::tools
